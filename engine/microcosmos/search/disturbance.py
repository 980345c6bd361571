"""Disturbed conditions: another phase, pose, viscosity or place of energy for a creature."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ..genomes import Genotype
from ..world import State
from .evaluation import Evaluation, evaluate_drive, over_trials
from .simulation import drive, turned
from .task import Task

Scalar = Float[Array, "*block"]


class Disturbance(eqx.Module):
    """Differences from the conditions of the first evaluation."""

    phase: Scalar
    """Lead of a periodic timer, in rad."""
    turn: Scalar
    """Turn of the body about its middle, in rad."""
    shift: Float[Array, "*block 2"]
    """Shift of the body, in cells."""
    viscosity: Scalar
    """A factor."""
    energy: Int[Array, "*block 2"]
    """Shift of the energy's packets, in cells."""


class Spread(eqx.Module):
    """Extent of each disturbance; 0 or False switches it off."""

    phase: bool = eqx.field(static=True, default=True)
    pose: bool = eqx.field(static=True, default=True)
    viscosity: float = eqx.field(static=True, default=0.05)
    energy: bool = eqx.field(static=True, default=True)


def disturbance(spread: Spread, size: tuple[int, int], *, key: PRNGKeyArray) -> Disturbance:
    """Draw a disturbance, uniform within the spread."""
    # A key for each part, also where it is switched off: the draws of the others stay the same.
    phase_key, turn_key, shift_key, viscosity_key, energy_key = jax.random.split(key, 5)
    sides = jnp.asarray(size, jnp.float32)
    whole = 2 * jnp.pi
    posed = float(spread.pose)
    change = jax.random.uniform(viscosity_key, minval=-1.0, maxval=1.0)
    return Disturbance(
        phase=whole * jax.random.uniform(phase_key) * float(spread.phase),
        turn=whole * jax.random.uniform(turn_key) * posed,
        shift=sides * jax.random.uniform(shift_key, (2,)) * posed,
        viscosity=1.0 + spread.viscosity * change,
        energy=jnp.floor(sides * jax.random.uniform(energy_key, (2,))).astype(jnp.int32)
        * int(spread.energy),
    )


def evaluate_disturbed(task: Task, genotype: Genotype, changed: Disturbance) -> Evaluation:
    """Simulate one creature under disturbed conditions, the same in all trials; measure it."""
    world = replace(task.world, viscosity=task.world.viscosity * changed.viscosity)
    task = replace(task, world=world, phase=changed.phase)

    def disturbed(one: Task) -> Evaluation:
        driven = drive(one, genotype)
        start = moved(driven.start, changed)
        return evaluate_drive(one, genotype, replace(driven, start=start))

    return over_trials(task, disturbed)


def moved(start: State, changed: Disturbance) -> State:
    """Return the start with the body turned and moved, and the energy moved."""
    start = turned(start, changed.turn)
    energy = start.energy
    if energy is not None:
        energy = jnp.roll(energy, changed.energy, (0, 1))
    return replace(start, positions=start.positions + changed.shift[None], energy=energy)
