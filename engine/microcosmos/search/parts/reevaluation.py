"""Reevaluation of elites under disturbed conditions, a test of their robustness.

Elites are the best of many noisy or fragile evaluations; Flageat and Cully, Artificial Life
32 (2020) and arXiv:2302.00463 correct an archive by evaluating its elites again.
"""

from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ...archive.curves import CORRECTED
from ..cells import Cells
from ..containers import cells_of
from ..disturbance import Disturbance, Spread, disturbance
from ..evaluation import Evaluation
from ..insertion import Elites, zeros
from ..loop import Ask, Leaf, Part, Plan, Program, State, Turn
from .records import columns_of

FIRST_SAMPLE = 2**30
"""Number of the first sample when keys are derived; smaller numbers are slots."""

AGAIN = "reevaluation"
"""Name of the program that evaluates elites under disturbed conditions."""


@dataclass(frozen=True)
class Settings:
    """Interval and conditions of reevaluation; see `spec.Reevaluation`."""

    every: int
    samples: int
    spread: Spread
    size: tuple[int, int]
    """Size of the world, in cells."""


@dataclass(frozen=True)
class Programs:
    """The compiled parts of reevaluation."""

    disturb: Callable[..., Disturbance]
    """The conditions in every cell, from a generation and a sample's number."""
    evaluate: Program
    add: Callable[..., "Repeats"]
    correct: Callable[..., Float[Array, "cell"]]
    forget: Callable[..., "Repeats"]


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


class Reevaluated(eqx.Module):
    """The results of reevaluation so far."""

    repeats: Repeats
    unrepeated: Repeats | None
    """`repeats` before a reevaluation that happened only because the run ended."""
    curves: Float[np.ndarray, "generation curve"]
    """Columns of `CORRECTED`."""


def part(settings: Settings, programs: Programs) -> Part:
    """Return the part that reevaluates all elites every few generations, and at the end."""

    def begin(plan: Plan) -> Reevaluated:
        none = no_repeats(plan.cell_count, len(plan.measures))
        return Reevaluated(none, None, np.zeros((0, len(CORRECTED))))

    def like(plan: Plan) -> Reevaluated:
        own = begin(plan)
        return replace(own, unrepeated=own.repeats)

    return Part(
        name="reevaluation",
        begin=begin,
        like=like,
        leaves={
            "repeats": Leaf("cell", "archive/repeats"),
            "unrepeated": Leaf("cell", "loop/unrepeated", optional=True),
            "curves": columns_of("curves", CORRECTED),
        },
        programs={AGAIN: programs.evaluate},
        placed=lambda own, turn: (_forgotten(programs, own, turn), turn),
        learn=lambda own, turn: _reevaluated(settings, programs, own, turn),
        figures=_figures,
        prolong=_prolonged,
        asks_late=True,
    )


def disturb(
    settings: Settings,
    key: PRNGKeyArray,
    cells: int,
    generation: Int[Array, ""],
    sample: Int[Array, ""],
) -> Disturbance:
    """Return the conditions in every cell, derived from seed, generation, sample and cell."""
    turn = jax.random.fold_in(jax.random.fold_in(key, generation), FIRST_SAMPLE + sample)
    keys = jax.vmap(lambda cell: jax.random.fold_in(turn, cell))(jnp.arange(cells))
    spread, size = settings.spread, settings.size
    return jax.vmap(lambda key: disturbance(spread, size, key=key))(keys)


def _forgotten(programs: Programs, own: Reevaluated, turn: Turn) -> Reevaluated:
    """Clear the results of elites that are gone."""
    settled = turn.settled
    inserted, occupied = settled.inserted, settled.elites.occupied
    kept = programs.forget(own.repeats, inserted.cell, inserted.entered, occupied)
    return replace(own, repeats=kept)


def _reevaluated(
    settings: Settings, programs: Programs, own: Reevaluated, turn: Turn
) -> Generator[Ask, Any, tuple[Reevaluated, Turn]]:
    """Reevaluate every elite if it is time, and add a row to the curves."""
    after, row = turn.after, np.full(len(CORRECTED), np.nan)
    early = turn.number % settings.every != 0
    if turn.over or not early:
        repeats = yield from _repeated(settings, programs, own.repeats, turn)
        # A run with more generations would not reevaluate at an early end.
        before = own.repeats if early and not after.ended else None
        own = replace(own, repeats=repeats, unrepeated=before)
        row = np.array(_corrected(programs, own, after))
    return replace(own, curves=np.concatenate([own.curves, row[None]])), turn


def _repeated(
    settings: Settings, programs: Programs, repeats: Repeats, turn: Turn
) -> Generator[Ask, Any, Repeats]:
    after, count = turn.after, turn.plan.cell_count
    cells, bins = np.flatnonzero(after.elites.occupied), cells_of(after.container)
    genotypes = jax.tree.map(lambda x: np.asarray(x)[cells], after.elites.genotypes)

    # The programs take a row for each place: with the number of elites they would be compiled
    # anew.
    def in_all_cells(rows: np.ndarray) -> np.ndarray:
        everywhere = np.zeros((count, *rows.shape[1:]), rows.dtype)
        everywhere[cells] = rows
        return everywhere

    for sample in range(settings.samples):
        changed = programs.disturb(jnp.asarray(after.generation), jnp.asarray(sample))
        changed = jax.tree.map(lambda x: np.asarray(x)[cells], changed)
        evaluation = yield Ask((genotypes, changed), AGAIN)
        everywhere = jax.tree.map(in_all_cells, evaluation)
        repeats = programs.add(repeats, after.elites, everywhere, bins)
    return repeats


def _corrected(
    programs: Programs, own: Reevaluated, state: State
) -> tuple[float, float, float]:
    """Return corrected QD score and coverage, and the share of repeats in their own cell."""
    count = np.asarray(own.repeats.count)
    if not count.any():
        return np.nan, np.nan, np.nan
    bins = cells_of(state.container)
    fitness = programs.correct(state.elites, own.repeats, bins)
    fitness = np.asarray(fitness, np.float64)
    known = fitness[np.isfinite(fitness)]
    hits = np.asarray(own.repeats.hits).sum() / count.sum()
    return float(known.sum()), len(known) / len(fitness), float(hits)


def _figures(own: Reevaluated, turn: Turn) -> dict[str, int | float]:
    pairs = zip(CORRECTED, own.curves[-1].tolist(), strict=True)
    return {name: value for name, value in pairs if np.isfinite(value)}


def _prolonged(own: Reevaluated, state: State) -> tuple[Reevaluated, State]:
    """Take back a reevaluation that happened only because the run ended."""
    if own.unrepeated is None:
        return own, state
    early = np.sum(np.asarray(own.repeats.count) - np.asarray(own.unrepeated.count))
    curves = own.curves.copy()
    curves[-1] = np.nan
    state = replace(state, evaluations=state.evaluations - int(early))
    return Reevaluated(own.unrepeated, None, curves), state


def forget(
    repeats: Repeats,
    cells: Int[Array, "row"],
    entered: Bool[Array, "row"],
    occupied: Bool[Array, "cell"],
) -> Repeats:
    """Clear the rows of cells with new elites, and of those that are empty."""
    # A place behind the last one is dropped, where −1 would be the last.
    place = jnp.where(entered, cells, len(occupied))
    kept = occupied.at[place].set(False, mode="drop")

    def cleared(x: Array) -> Array:
        return jnp.where(kept.reshape(-1, *[1] * (x.ndim - 1)), x, jnp.zeros((), x.dtype))

    return jax.tree.map(cleared, repeats)


def add(repeats: Repeats, elites: Elites, results: Evaluation, cells: Cells) -> Repeats:
    """Add one reevaluation of every elite (Welford 1962).

    `results` has a row for each place; rows of empty places are ignored.
    """
    done, homes = elites.occupied, cells.of(elites.measures)
    old, feasible = repeats, done & (results.status == 0)
    n = old.count - old.failed + feasible
    share = jnp.where(feasible, 1 / jnp.maximum(n, 1), 0.0)
    step = jnp.where(feasible, results.fitness - old.fitness, 0.0)
    strayed = jnp.where(feasible[:, None], results.measures - old.measures, 0.0)
    mean = old.fitness + share * step
    return Repeats(
        count=old.count + done,
        failed=old.failed + (done & ~feasible),
        hits=old.hits + (feasible & (cells.of(results.measures) == homes)),
        fitness=mean,
        squares=old.squares + jnp.where(feasible, step * (results.fitness - mean), 0.0),
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
