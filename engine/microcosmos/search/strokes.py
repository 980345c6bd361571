"""Evaluation of hand-made gaits: the same stroke in a block of conditions."""

from dataclasses import replace
from functools import partial

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .. import units
from ..filaments import Rest
from ..world import Limits, Measures, State, World, centre, flow, rollout
from .evaluation import Evaluation, Task
from .measures import MOTION, motion, observe

STROKE_MEASURES = (
    *MOTION,
    "energy",
    "mach",
    "limited",
    "reynolds",
    "cycle",
    "direction",
    "impulse",
)
"""Measures of every stroke, in this order; units in `docs/formats.md`."""


class Conditions(eqx.Module):
    """The conditions of one point of a sweep."""

    viscosity: Float[Array, "*block"]
    limits: Limits


class Watched(eqx.Module):
    """Observations of a step for checks of the physics."""

    observed: Measures
    mach: Float[Array, "*time"]
    """Mach number of the fastest fluid anywhere."""
    force: Float[Array, "*time group 2"]


def watch(world: World, state: State, measures: Measures) -> Watched:
    """Return the observations, the Mach number of the whole flow, and the forces of bodies."""
    assert measures.force is not None
    u = flow(world, state)
    fastest = jnp.sqrt(jnp.max(jnp.sum(u * u, 0)))
    return Watched(observe(state, measures), units.mach(fastest), measures.force)


def impulse(watched: Watched) -> Float[Array, ""]:
    """Return the largest net momentum that a body has given to the fluid at any time."""
    return jnp.max(jnp.sqrt(jnp.sum(jnp.cumsum(watched.force, 0) ** 2, -1)))


def swim(task: Task, rest: Rest, conditions: Conditions, period: int) -> Evaluation:
    """Carry out a stroke under its conditions and measure its last cycle."""
    world = replace(task.world, viscosity=conditions.viscosity, limits=conditions.limits)
    end, watched = rollout(world, task.start, rest, partial(watch, world))
    observed = watched.observed
    values = motion(world, task.start, end, observed, task.length)
    before = (
        observed.centre[-1 - period]
        if len(observed.node_speed) > period
        else centre(world, task.start)
    )
    cycle = observed.centre[-1] - before
    values["mach"] = jnp.max(watched.mach)
    values["cycle"] = jnp.sqrt(jnp.sum(cycle * cycle))
    values["direction"] = jnp.arctan2(cycle[1], cycle[0])
    values["impulse"] = impulse(watched)
    measures = jnp.stack([values[name] for name in STROKE_MEASURES])
    finite = jnp.all(jnp.isfinite(measures))
    status = jnp.where(finite, jnp.where(values["mach"] < 1, 0, 2), 1)
    return Evaluation(values["displacement"], measures, status)
