"""Evaluation of hand-made gaits: the same stroke in a block of conditions."""

from dataclasses import replace

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..filaments import Rest
from ..genomes import Drive
from ..world import Limits, centre
from .evaluation import Evaluation
from .measures import MOTION, motion
from .simulation import simulate
from .task import Task

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


def swim(task: Task, rest: Rest, conditions: Conditions, period: int) -> Evaluation:
    """Carry out a stroke under its conditions and measure its last cycle."""
    world = replace(task.world, viscosity=conditions.viscosity, limits=conditions.limits)
    end, observed = simulate(Drive(world, task.start, rest))
    values = motion(world, task.start, end, observed, task.length)
    before = (
        observed.centre[-1 - period]
        if len(observed.node_speed) > period
        else centre(world, task.start)
    )
    cycle = observed.centre[-1] - before
    values["cycle"] = jnp.sqrt(jnp.sum(cycle * cycle))
    values["direction"] = jnp.arctan2(cycle[1], cycle[0])
    measures = jnp.stack([values[name] for name in STROKE_MEASURES])
    finite = jnp.all(jnp.isfinite(measures))
    status = jnp.where(finite, jnp.where(values["mach"] < 1, 0, 2), 1)
    return Evaluation(values["displacement"], measures, status)
