"""Reevaluation of elites under disturbed conditions, a test of their robustness.

Elites are the best of many noisy or fragile evaluations; Flageat and Cully, Artificial Life
32 (2020) and arXiv:2308.00463 correct an archive by evaluating its elites again.
"""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ..genomes import Genotype
from ..world import State
from .cells import Cells
from .evaluation import Evaluation, evaluate_drive
from .insertion import Elites, zeros
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


class Repeats(eqx.Module):
    """Results of reevaluation, a row for each place of an elite."""

    count: Int[Array, "cell"]
    """Reevaluations of the present elite."""
    failed: Int[Array, "cell"]
    """Infeasible reevaluations; no mean includes them."""
    hits: Int[Array, "cell"]
    """Reevaluations whose descriptors fell into the elite's cell or bins."""
    fitness: Float[Array, "cell"]
    """Mean fitness."""
    squares: Float[Array, "cell"]
    """Sum of squared deviations of fitness from its mean."""
    measures: Float[Array, "cell measure"]
    """Means of measures."""


def no_repeats(cells: int, measures: int) -> Repeats:
    none, zero = zeros(np.int32, cells), zeros(np.float32, cells)
    return Repeats(none, none, none, zero, zero, zeros(np.float32, cells, measures))


def disturbance(spread: Spread, size: tuple[int, int], *, key: PRNGKeyArray) -> Disturbance:
    """Draw a disturbance, uniform within the spread."""
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
    """Simulate one creature under disturbed conditions and measure it."""
    world = replace(task.world, viscosity=task.world.viscosity * changed.viscosity)
    task = replace(task, world=world, phase=changed.phase)
    driven = drive(task, genotype)
    return evaluate_drive(task, genotype, replace(driven, start=moved(driven.start, changed)))


def moved(start: State, changed: Disturbance) -> State:
    """Return the start with the body turned and moved, and the energy moved."""
    start = turned(start, changed.turn)
    energy = start.energy
    if energy is not None:
        energy = jnp.roll(energy, changed.energy, (0, 1))
    return replace(start, positions=start.positions + changed.shift[None], energy=energy)


def forget(
    repeats: Repeats,
    cells: Int[Array, "row"],
    entered: Bool[Array, "row"],
    occupied: Bool[Array, "cell"],
) -> Repeats:
    """Clear the rows of cells with new elites, and of those that are empty."""
    place = jnp.where(entered, cells, len(occupied))
    kept = occupied.at[place].set(False, mode="drop")

    def cleared(x: Array) -> Array:
        return jnp.where(kept.reshape(-1, *[1] * (x.ndim - 1)), x, jnp.zeros((), x.dtype))

    return jax.tree.map(cleared, repeats)


def add(repeats: Repeats, elites: Elites, found: Evaluation, cells: Cells) -> Repeats:
    """Add one reevaluation of every elite (Welford 1962).

    `found` has a row for each place; those of empty places are ignored.
    """
    done, homes = elites.occupied, cells.of(elites.measures)
    old, feasible = repeats, done & (found.status == 0)
    n = old.count - old.failed + feasible
    share = jnp.where(feasible, 1 / jnp.maximum(n, 1), 0.0)
    step = jnp.where(feasible, found.fitness - old.fitness, 0.0)
    strayed = jnp.where(feasible[:, None], found.measures - old.measures, 0.0)
    mean = old.fitness + share * step
    return Repeats(
        count=old.count + done,
        failed=old.failed + (done & ~feasible),
        hits=old.hits + (feasible & (cells.of(found.measures) == homes)),
        fitness=mean,
        squares=old.squares + jnp.where(feasible, step * (found.fitness - mean), 0.0),
        measures=old.measures + share[:, None] * strayed,
    )


def corrected(elites: Elites, repeats: Repeats, cells: Cells) -> Float[Array, "cell"]:
    """Return the fitness of the corrected archive, NaN in empty cells.

    It places every reevaluated elite by its mean descriptors and keeps the best mean fitness of
    each cell.
    """
    known = elites.occupied & (repeats.count > repeats.failed)
    place = jnp.where(known, cells.of(repeats.measures), cells.count)
    best = jnp.full(cells.count, -jnp.inf).at[place].max(repeats.fitness, mode="drop")
    return jnp.where(jnp.isfinite(best), best, jnp.nan)
