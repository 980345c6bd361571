"""Build what surrounds bodies in the box: walls, obstacles and a flow."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import fields, fluid, spec, world
from ..device import array
from ..fields import barrier


def build_surroundings(box: spec.World, dtype: Any = jnp.float32) -> fluid.Surroundings:
    """Build the walls of the fluid, and the force that keeps a flow up."""
    solid, flow = box.solid, build_flow(box)
    around = fluid.Surroundings(solid=None if solid is None else array(solid))
    if flow is None:
        return around
    force = array(flow.force, dtype)
    return replace(around, **{"force" if force.ndim == 1 else "force_field": force})


def build_flow(box: spec.World) -> fluid.Developed | None:
    """Build the flow of a box, if there is one."""
    flow, size = box.flow, (box.width, box.height)
    if flow is None:
        return None
    if flow.kind == "vortices":
        return fluid.vortices(size, flow.speed, box.viscosity, flow.vortices)
    kind = fluid.poiseuille if flow.kind == "poiseuille" else fluid.shear
    return kind(size, flow.speed, box.viscosity)


def build_start(box: spec.World, place: world.World, positions: np.ndarray) -> world.State:
    """Build the start: bodies at `positions`, the fluid at rest or in its flow.

    Around obstacles the flow starts as it is without them.
    """
    dtype = place.viscosity.dtype
    at_rest = jax.jit(world.at_rest)  # One program instead of forty.
    start = at_rest(place, array(positions, dtype))
    flow = build_flow(box)
    if flow is None:
        return start
    solid = place.surroundings.solid
    planes = fluid.developed(flow, box.viscosity)
    if solid is not None:
        planes = tuple(jnp.where(solid, 0.0, plane) for plane in planes)
    planes = tuple(jnp.asarray(plane, dtype) for plane in planes)
    return replace(start, populations=planes)


def build_barrier(box: spec.World, dtype: Any) -> fields.Barrier | None:
    """Build what keeps bodies out of solid cells, if there are any."""
    solid = box.solid
    if solid is None:
        return None
    away = array(fields.away(solid), dtype)
    return fields.Barrier(away, array(barrier.LIMIT, dtype))
