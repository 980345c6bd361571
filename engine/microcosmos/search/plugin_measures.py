"""The data that plug-in measures are computed from."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..filaments import Rest
from ..world import State, World, centre, edges_there, mean
from .measures import Observations

Scalar = Float[Array, ""]


class Motion(eqx.Module):
    """The life of one creature; moments are its start and the end of every step."""

    path: Float[Array, "moment 2"]
    """Mean place of its nodes, in cells, not wrapped around the world."""
    heading: Float[Array, "moment"]
    """Mean direction of its edges, in rad."""
    rest: Rest
    """What was asked for in each step: `angle` (time, joint) in rad, `length` (time, edge)."""
    curvature: Float[Array, "time joint"]
    """In 1/cells."""
    pace: Float[Array, "time"]
    """Mean speed of nodes, in cells a step."""
    power: Float[Array, "time"]
    """What the body spends on the fluid."""
    start: Float[Array, "node 2"]
    """Places of nodes at the start, in cells."""
    end: Float[Array, "node 2"]
    """And at the end."""
    viscosity: Scalar
    measures: dict[str, Scalar]
    """What is measured of everybody, by the names of `spec.measures`."""


@dataclass(frozen=True)
class Measure:
    """A number that is measured beside the usual ones."""

    name: str
    of: Callable[[Motion], Scalar]


def motion_for_plugins(
    world: World, start: State, end: State, observed: Observations, measures: dict[str, Any]
) -> Motion:
    """A simulation as plug-in measures see it."""
    first = mean(start.angles, edges_there(world))
    return Motion(
        path=jnp.concatenate([centre(world, start)[None], observed.centre]),
        heading=jnp.concatenate([first[None], observed.heading]),
        rest=observed.rest,
        curvature=observed.curvature,
        pace=observed.pace,
        power=observed.power,
        start=start.positions,
        end=end.positions,
        viscosity=world.viscosity,
        measures=measures,
    )
