"""One stroke of a creature in open loop, from its rest shapes alone, and how it would swim.

The controller is evaluated at equal phases of its clock instead of at every step, which costs a
hundredth of it. Actuators bound the bend, slow the clock and lag, as in `genomes.actuators`.

Swimming is by resistive force theory: each edge is a slender element whose drag across is twice
that along it, and a free body moves so that force and torque vanish (Gray and Hancock, J. Exp.
Biol. 32, 802 (1955); Lauga and Powers, Rep. Prog. Phys. 72, 096601 (2009), section 5.2).
Inertia, walls and other parts of the body are left out, so speeds are rough; they serve as
inputs of a model.
"""

from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from ...filaments import Layout, Rest
from ...genomes import Drive, Genotype, sine_cosine
from ...portable import arctangent, cosine, long_product, root, sine
from ...world import grown_nodes, present_edges
from ..task import Task

PHASES = 32
"""Phases of a stroke, as many as frames of a recorded one."""

Shapes = Float[Array, "phase node 2"]


class Stroke(eqx.Module):
    """A body that repeats one stroke: its shapes at equal phases, and the time between them."""

    rest: Rest
    """Rest angles (phase, joint) in rad, rest lengths (phase, edge) in cells."""
    shapes: Shapes
    """Positions of nodes about their mean, in cells; absent nodes are included."""
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

    # The kinematics are those of `filaments.rest_positions` and `filaments.fitted`, for all
    # phases at once and in portable arithmetic: a processor must not decide which offspring are
    # simulated.
    def _stroke(self, driven: Drive) -> Stroke:
        layout = self.layout if driven.layout is None else driven.layout
        weight = grown_nodes(driven.world).astype(layout.placed.dtype)
        actuators, rest = self.task.actuators, driven.inputs
        took = jnp.full(PHASES, self.period / PHASES, weight.dtype)
        if actuators is not None:
            if actuators.max_bend is not None:
                rest = _bounded(rest, layout, present_edges(driven.world), actuators.max_bend)
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


def _bounded(rest: Rest, layout: Layout, grown: Any, most: float) -> Rest:
    """Return rest shapes whose bend, relative to the body at rest, is within the bound."""
    turned = _turned(rest, layout)
    if grown is not None:
        turned = jnp.where(grown[None], turned, turned[:, :1])
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


RATIO = 2.0
"""Drag across an element over that along it."""

Phases = Float[Array, "phase"]


class Swim(eqx.Module):
    """The motion of a free body through a stroke."""

    rigid: Float[Array, "phase 3"]
    """Velocity of the body in its own frame, in cells a step, and its rate of turn."""
    velocity: Shapes
    """Velocities of nodes in the frame of the body, in cells a step."""
    power: Phases
    """Power against a drag along the body of 1 per cell."""
    heading: Phases
    """Turn of the body's frame at each phase since the first, in rad."""
    displacement: Float[Array, "2"]
    """Displacement in the stroke, in the frame of the first phase, in cells."""
    turn: Float[Array, ""]
    """Turn in the stroke, in rad."""


def swim(stroke: Stroke, edges: Int[Array, "edge 2"], grown: Float[Array, "edge"]) -> Swim:
    """Return the motion of a body; edges whose weight `grown` is 0 have no drag."""
    took = stroke.took[:, None, None]
    begin, end = stroke.shapes[:, edges[:, 0]], stroke.shapes[:, edges[:, 1]]
    middle, span = 0.5 * (begin + end), end - begin
    length = jnp.sqrt(jnp.sum(span * span, 2) + 1e-12)[..., None]
    tangent, weight = span / length, length * grown[None, :, None]
    deformation = stroke.changes / took
    own = 0.5 * (deformation[:, edges[:, 0]] + deformation[:, edges[:, 1]])

    def drag(velocity):
        along = jnp.sum(tangent * velocity, 2, keepdims=True)
        return weight * (RATIO * velocity - (RATIO - 1) * tangent * along)

    one, none = jnp.ones_like(middle[..., 0]), jnp.zeros_like(middle[..., 0])
    modes = [(one, none), (none, one), (-middle[..., 1], middle[..., 0])]
    modes = [jnp.stack(mode, 2) for mode in modes]
    drags = [drag(mode) for mode in modes]
    resistance = [[jnp.sum(a * b, (1, 2)) for b in drags] for a in modes]
    pushed = drag(own)
    rigid = _solved(resistance, [-jnp.sum(mode * pushed, (1, 2)) for mode in modes])
    force = pushed + sum(v[:, None, None] * f for v, f in zip(rigid, drags, strict=True))
    moved = own + sum(v[:, None, None] * mode for v, mode in zip(rigid, modes, strict=True))
    x, y = stroke.shapes[..., 0], stroke.shapes[..., 1]
    across, along, turning = (v[:, None] for v in rigid)
    carried = jnp.stack([across - turning * y, along + turning * x], 2)
    heading, displacement, turn = _path(rigid, stroke)
    return Swim(
        rigid=jnp.stack(rigid, 1),
        velocity=deformation + carried,
        power=jnp.sum(force * moved, (1, 2)),
        heading=heading,
        displacement=displacement,
        turn=turn,
    )


def _solved(a: list[list[Phases]], b: list[Phases]) -> list[Phases]:
    """Solve three equations by Cramer's rule; the matrix is positive definite."""
    (p, q, r), (_, s, t), (_, _, u) = a
    cofactors = [
        [s * u - t * t, r * t - q * u, q * t - r * s],
        [r * t - q * u, p * u - r * r, q * r - p * t],
        [q * t - r * s, q * r - p * t, p * s - q * q],
    ]
    determinant = p * cofactors[0][0] + q * cofactors[0][1] + r * cofactors[0][2]
    safe = jnp.maximum(determinant, 1e-12)
    return [(row[0] * b[0] + row[1] * b[1] + row[2] * b[2]) / safe for row in cofactors]


def _path(rigid: list[Phases], stroke: Stroke) -> tuple[Phases, Array, Array]:
    """Return heading, displacement and turn of the body's frame."""
    across, along, turning = rigid
    turned = turning * stroke.took
    after = jnp.cumsum(turned + stroke.turns)
    heading = jnp.concatenate([jnp.zeros_like(after[:1]), after[:-1]])
    middle = heading + turned / 2
    c, s = cosine(middle), sine(middle)
    x = jnp.sum((c * across - s * along) * stroke.took)
    y = jnp.sum((s * across + c * along) * stroke.took)
    return heading, jnp.stack([x, y]), after[-1]
