"""Bodies whose measures are inherited: rest angles and lengths, stiffnesses, and nodes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from ..world import State, World, at_rest, centre, grown_rods
from .development import Controls

Traits = Mapping[str, Array]
"""Values of each joint or edge, by what they are values of."""

STIFFNESSES = ("stretch", "shear", "bend")


@dataclass(frozen=True)
class Plan:
    """How the shape of a body follows from angles and lengths; NumPy arrays.

    Turns are those of joints that turn independently, the first dimension of `turned`'s
    rows; `ways` lead from the first node to every other.
    """

    angle: np.ndarray
    """(edge,) direction of each edge of the body as it is, in rad."""
    length: np.ndarray
    """(edge,) its length in cells."""
    joints: np.ndarray
    """(joint, 2) pairs of edges."""
    turned: np.ndarray
    """(edge, turn) which edges a turn of a joint turns."""
    ways: np.ndarray
    """(node, edge) the edges on the way to each node, with their senses."""
    free: np.ndarray
    """(turn,) the joints that turn independently."""


@dataclass(frozen=True)
class Shaped:
    """A body on its way: the world and start with it, and controls of its own rest shape."""

    world: World
    start: State
    controls: Controls
    length: Float[Array, ""] | None = None
    """How far it reaches, in cells; None: as far as the body that it is made of."""


def within(values: Array, bounds: tuple[float, float]) -> Array:
    """From −1 to 1 to what lies between bounds."""
    low, high = bounds
    return low + (high - low) * 0.5 * (1 + values)


def shaped(
    world: World, start: State, controls: Controls, plan: Plan | None, traits: Traits
) -> Shaped:
    """The body with other measures, laid out anew where angles or lengths are among them.

    `rest_angle` is added to rest angles at the plan's free joints, `rest_length` multiplies.
    """
    stiffness = {name: traits[name] for name in STIFFNESSES if name in traits}
    world = replace(world, rods=replace(world.rods, **stiffness))
    if plan is None:
        return Shaped(world, start, controls)
    dtype = start.positions.dtype
    factor = traits.get("rest_length", jnp.ones(len(plan.length), dtype))
    turns = traits.get("rest_angle", jnp.zeros(len(plan.free), dtype))
    turned = jnp.asarray(plan.turned, dtype) @ turns
    positions = _laid_out(plan, turned, factor) + jnp.mean(start.positions, 0)[None]
    first, second = plan.joints.T
    controls = replace(
        controls,
        rest_angle=jnp.asarray(controls.rest_angle, dtype) + turned[second] - turned[first],
        rest_length=jnp.asarray(controls.rest_length, dtype) * factor,
    )
    start = replace(at_rest(world, positions), energy=start.energy)
    return Shaped(world, start, controls)


def cut(body: Shaped, present: Bool[Array, "node"]) -> Shaped:
    """A chain of which only some nodes are there, their middle where the whole one's was."""
    rods = grown_rods(body.world.rods, present)
    world = replace(body.world, rods=rods, present=present)
    middle = jnp.mean(body.start.positions, 0)
    positions = body.start.positions + (middle - centre(world, body.start))[None]
    lengths = jnp.asarray(body.controls.rest_length, positions.dtype)
    reach = jnp.sum(jnp.where(jnp.all(present[rods.edges], 1), lengths, 0.0))
    start = replace(body.start, positions=positions)
    return replace(body, world=world, start=start, length=reach)


def _laid_out(plan: Plan, turned: Array, factor: Array) -> Float[Array, "node 2"]:
    """Positions about their own mean."""
    dtype = turned.dtype
    angle = jnp.asarray(plan.angle, dtype) + turned
    v = jnp.stack([jnp.cos(angle), jnp.sin(angle)], 1)
    v = v * (jnp.asarray(plan.length, dtype) * factor)[:, None]
    positions = jnp.asarray(plan.ways, dtype) @ v
    return positions - jnp.mean(positions, 0)[None]
