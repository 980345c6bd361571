"""Computation of the measures of a step."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .. import filaments
from .model import Measures, State, World
from .present import centre, edges_there, joints_there, mean

Points = Float[Array, "point 2"]


class Pushed(eqx.Module):
    """Exchange between bodies and fluid in a step, at the points where they meet."""

    speed: Float[Array, ""]
    """Speed of the fastest fluid before the step."""
    forcing: Points
    """Force on the fluid."""
    target: Points
    """Motion of the bodies, without the drift by repulsion."""
    moved: Float[Array, "node 2"]
    """Motion of the nodes before the projection."""
    held: Float[Array, "node"]
    """1 where a limit acted."""


def measure(world: World, end: State, rest: filaments.Rest, pushed: Pushed) -> Measures:
    """Return the measures of a step that ended in `end`."""
    groups = world.groups.repeated(world.form.layers)
    speed = jnp.sqrt(jnp.sum(pushed.moved * pushed.moved, 1) + 1e-24)
    return Measures(
        speed=pushed.speed,
        node_speed=mean(speed, world.present),
        held=mean(pushed.held, world.present),
        force=groups.total(pushed.forcing),
        rest=rest,
        centre=centre(world, end),
        positions=end.positions,
        heading=mean(end.angles, edges_there(world)),
        curvature=curvature(world, end.positions, end.angles),
        power=jnp.sum(pushed.forcing * pushed.target),
    )


def curvature(
    world: World, positions: Float[Array, "node 2"], angles: Float[Array, "edge"]
) -> Float[Array, "joint"]:
    """Return the angle at each joint over the mean length of its edges."""
    rods = world.rods
    if rods.joints is None:
        return jnp.zeros_like(rods.bend)
    first, second = rods.joints[:, 0], rods.joints[:, 1]
    v = positions[rods.edges[:, 1]] - positions[rods.edges[:, 0]]
    length = jnp.sqrt(jnp.sum(v * v, 1) + 1e-24)
    angle = filaments.wrap(angles[second] - angles[first])
    found = 2 * angle / (length[first] + length[second])
    kept = joints_there(world)
    return found if kept is None else jnp.where(kept, found, 0.0)
