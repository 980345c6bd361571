"""One stroke of a creature in open loop, from its rest shapes alone.

The controller is evaluated at equal phases of its clock instead of at every step, which costs a
hundredth of it. Actuators bound the bend, slow the clock and lag, as in `genomes.actuators`.

The kinematics are those of `filaments.rest_positions` and `filaments.fitted`, for all phases at
once and in portable arithmetic: which offspring are simulated must not depend on a processor.
"""

from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ...filaments import Layout, Rest
from ...genomes import Drive, Genotype, sine_cosine
from ...portable import arctangent, cosine, long_product, root, sine
from ...world import edges_there, grown_nodes
from ..task import Task

PHASES = 32
"""Phases of a stroke, as many as frames of a recorded one."""

Shapes = Float[Array, "phase node 2"]


class Stroke(eqx.Module):
    """A body that repeats one stroke: its shapes at equal phases, and the time between them."""

    rest: Rest
    """Rest angles (phase, joint) in rad, rest lengths (phase, edge) in cells."""
    shapes: Shapes
    """Positions of nodes about their mean, in cells; absent nodes are there."""
    changes: Shapes
    """Displacement of nodes to the next shape, less the rigid motion that makes it smallest."""
    turns: Float[Array, "phase"]
    """Turn, in rad, that was taken off the next shape."""
    took: Float[Array, "phase"]
    """Steps from each shape to the next."""


@dataclass(frozen=True)
class Strokes:
    """The strokes of a task's creatures."""

    task: Task
    layout: Layout
    """Layout of the task's body; a genome that grows one brings its own."""
    period: float
    """Steps of the controller's clock in a stroke."""
    steps: int
    """Steps of a simulation."""

    def of(self, genotype: Genotype) -> tuple[Drive, Stroke]:
        """Return a creature in its world, and its stroke."""
        encoding: Any = self.task.encoding
        timer, ramp = sine_cosine(PHASES, float(PHASES)), np.ones(PHASES)
        encoding = replace(
            encoding, controls=replace(encoding.controls, timer=timer, ramp=ramp)
        )
        driven = encoding.drive(self.task.world, self.task.start, genotype, None)
        return driven, self._stroke(driven)

    def _stroke(self, driven: Drive) -> Stroke:
        layout = self.layout if driven.layout is None else driven.layout
        weight = grown_nodes(driven.world).astype(layout.placed.dtype)
        actuators, rest = self.task.actuators, driven.inputs
        took = jnp.full(PHASES, self.period / PHASES, weight.dtype)
        if actuators is not None:
            if actuators.max_bend is not None:
                rest = _bounded(rest, layout, edges_there(driven.world), actuators.max_bend)
            if actuators.max_speed is not None:
                changes, _ = _changes(_shapes(rest, layout, weight), weight)
                squares = jnp.sum(changes * changes, 2) * weight[None]
                farthest = root(jnp.max(squares, 1) + 1e-20)
                took = jnp.maximum(took, farthest / actuators.max_speed)
            rest = _lagged(rest, took, actuators.lag)
        shapes = _shapes(rest, layout, weight)
        return Stroke(rest, shapes, *_changes(shapes, weight), took)


def _turned(rest: Rest, layout: Layout) -> Float[Array, "phase edge"]:
    straight = jnp.broadcast_to(layout.rest_angle, rest.angle.shape)
    return long_product(rest.angle - straight, layout.turned.T)


def _bounded(rest: Rest, layout: Layout, there: Any, most: float) -> Rest:
    """Return rest shapes whose bend, relative to the body at rest, is within the bound."""
    turned = _turned(rest, layout)
    if there is not None:
        turned = jnp.where(there[None], turned, turned[:, :1])
    span = jnp.max(turned, 1) - jnp.min(turned, 1)
    share = jnp.minimum(1.0, most / jnp.maximum(span, 1e-6))[:, None]
    straight = jnp.broadcast_to(layout.rest_angle, rest.angle.shape)
    return Rest(straight + share * (rest.angle - straight), rest.length)


def _shapes(rest: Rest, layout: Layout, weight: Float[Array, "node"]) -> Shapes:
    turned = _turned(rest, layout)
    angle = turned + jnp.broadcast_to(layout.angle, turned.shape)
    along = [rest.length * f(angle) for f in (cosine, sine)]
    places = jnp.stack([long_product(one, layout.placed.T) for one in along], 2)
    middle = jnp.sum(places * weight[None, :, None], 1) / jnp.sum(weight)
    return places - middle[:, None]


def _changes(
    shapes: Shapes, weight: Float[Array, "node"]
) -> tuple[Shapes, Float[Array, "phase"]]:
    """Return the change to the next shape, and the turn taken off that."""
    x, y = shapes[..., 0], shapes[..., 1]
    next_x, next_y = jnp.roll(x, -1, 0), jnp.roll(y, -1, 0)
    dot = jnp.sum(weight[None] * (next_x * x + next_y * y), 1)
    cross = jnp.sum(weight[None] * (next_x * y - next_y * x), 1)
    size = root(dot * dot + cross * cross + 1e-20)
    c, s = (dot / size)[:, None], (cross / size)[:, None]
    after = jnp.stack([c * next_x - s * next_y, s * next_x + c * next_y], 2)
    return after - shapes, arctangent(cross, dot)


def _lagged(rest: Rest, took: Float[Array, "phase"], lag: float) -> Rest:
    """Return the first-order response to the second of two equal strokes."""
    if not lag:
        return rest
    kept = jnp.exp(-took / lag)

    def follow(before: Rest, phase: Array) -> tuple[Rest, Rest]:
        def step(old, commands):
            return commands[phase] + kept[phase] * (old - commands[phase])

        after = jax.tree.map(step, before, rest)
        return after, after

    first = jax.tree.map(lambda commands: commands[0], rest)
    twice = jnp.arange(2 * PHASES) % PHASES
    _, followed = jax.lax.scan(follow, first, twice)
    return jax.tree.map(lambda x: x[PHASES:], followed)
