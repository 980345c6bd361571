"""Evaluation of hand-made gaits: the same stroke in a block of conditions."""

from dataclasses import replace

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..filaments import Rest
from ..world import Limits
from .evaluation import STATUSES, Evaluation, all_finite, fitness_of, measured
from .measures import MOTION
from .simulation import drive, simulate
from .task import Task

STROKE_MEASURES = (
    *MOTION,
    "energy",
    "mach",
    "limited",
    "reynolds",
    "cycle_x",
    "cycle_y",
    "impulse",
)
"""Measures of every stroke, in this order; units in `docs/formats.md`."""


class Conditions(eqx.Module):
    """The conditions of one point of a sweep."""

    viscosity: Float[Array, "*block"]
    limits: Limits


def in_conditions(task: Task, conditions: Conditions) -> Task:
    """Return the task of one body that is simulated once, in the conditions of a point."""
    world = replace(task.world, viscosity=conditions.viscosity, limits=conditions.limits)
    return replace(task, world=world, trials=1, placements=None, places=None)


def swim(task: Task, rest: Rest, conditions: Conditions, period: int) -> Evaluation:
    """Carry out a stroke under its conditions and measure its last cycle."""
    task = in_conditions(task, conditions)
    driven = drive(task, rest)
    end, observed = simulate(driven)
    values, poses, valid = measured(task, driven, end, observed)
    whole = len(observed.power) > period
    before = observed.centre[-1 - period] if whole else poses.path[0]
    values["cycle_x"], values["cycle_y"] = observed.centre[-1] - before
    measures = jnp.stack([values[name] for name in STROKE_MEASURES])
    valid = jnp.where(all_finite(measures), valid, STATUSES.index("non-finite"))
    return Evaluation(fitness_of(task, values), measures, valid)
