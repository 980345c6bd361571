"""Build what surrounds bodies in the box: walls and obstacles."""

from typing import Any

import jax.numpy as jnp

from .. import fields, fluid, spec
from ..fields import barrier


def build_surroundings(box: spec.World) -> fluid.Surroundings:
    """Build the walls of the fluid."""
    solid = box.solid
    return fluid.Surroundings(solid=None if solid is None else jnp.asarray(solid))


def build_barrier(box: spec.World, dtype: Any) -> fields.Barrier | None:
    """Build what keeps bodies out of solid cells, if there are any."""
    solid = box.solid
    if solid is None:
        return None
    away = jnp.asarray(fields.away(solid), dtype)
    return fields.Barrier(away, jnp.asarray(barrier.LIMIT, dtype))
