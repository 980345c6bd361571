"""Reevaluation of elites, and figures of the corrected archive."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray

from .. import search
from ..search.reevaluation import Disturbance, Repeats, disturbance
from .state import Plan, Reevaluation, State

FIRST_SAMPLE = 2**30
"""Number of the first sample when keys are derived; smaller numbers are slots."""


@dataclass(frozen=True)
class Programs:
    """The compiled parts of reevaluation."""

    disturb: Callable[..., Disturbance]
    """The conditions in every cell, from a generation and a sample's number."""
    evaluate_block: Callable[..., search.Evaluation]
    add: Callable[..., Repeats]
    correct: Callable[..., Float[Array, "cell"]]


def disturb(
    reevaluation: Reevaluation,
    key: PRNGKeyArray,
    cells: int,
    generation: Int[Array, ""],
    sample: int,
) -> Disturbance:
    """Return the conditions in every cell, derived from seed, generation, sample and cell."""
    turn = jax.random.fold_in(jax.random.fold_in(key, generation), FIRST_SAMPLE + sample)
    keys = jax.vmap(lambda cell: jax.random.fold_in(turn, cell))(jnp.arange(cells))
    spread, size = reevaluation.spread, reevaluation.size
    return jax.vmap(lambda key: disturbance(spread, size, key=key))(keys)


def due(plan: Plan, state: State) -> bool:
    """Return whether elites are reevaluated after the state's generation."""
    if plan.reevaluation is None:
        return False
    last = bool(state.ended) or state.generation >= plan.generations
    return last or state.generation % plan.reevaluation.every == 0


def evaluate(
    plan: Plan,
    programs: Programs,
    devices: search.Devices,
    state: State,
    stop: Callable[[], bool],
) -> State:
    """Return the state with every elite reevaluated; raises `Stopped` as `advance` does."""
    assert plan.reevaluation is not None
    began = devices.seconds()
    cells, repeats = np.flatnonzero(state.elites.occupied), state.repeats
    bins = search.cells_of(state.container)
    genotypes = jax.tree.map(lambda x: np.asarray(x)[cells], state.elites.genotypes)

    def in_all_cells(rows: np.ndarray) -> np.ndarray:
        everywhere = np.zeros((plan.cell_count, *rows.shape[1:]), rows.dtype)
        everywhere[cells] = rows
        return everywhere

    for sample in range(plan.reevaluation.samples):
        changed = programs.disturb(jnp.asarray(state.generation), jnp.asarray(sample))
        changed = jax.tree.map(lambda x: np.asarray(x)[cells], changed)
        found = devices.evaluate(
            programs.evaluate_block, (genotypes, changed), block=plan.block, stop=stop
        )
        if plan.feasible:
            found = search.judged(found)
        everywhere = jax.tree.map(in_all_cells, found)
        repeats = programs.add(repeats, state.elites, everywhere, bins)
    # A run with more generations would not reevaluate here.
    early = not state.ended and state.generation % plan.reevaluation.every != 0
    before = state.repeats if early else None
    return replace(
        state,
        evaluations=state.evaluations + plan.reevaluation.samples * len(cells),
        repeats=repeats,
        unrepeated=before,
        device_seconds=state.device_seconds + devices.seconds() - began,
    )


def figures(programs: Programs, state: State) -> tuple[float, float, float]:
    """Return corrected QD score and coverage, and the share of repeats in their own cell."""
    count = np.asarray(state.repeats.count)
    if not count.any():
        return np.nan, np.nan, np.nan
    bins = search.cells_of(state.container)
    corrected = programs.correct(state.elites, state.repeats, bins)
    corrected = np.asarray(corrected, np.float64)
    there = corrected[np.isfinite(corrected)]
    hits = np.asarray(state.repeats.hits).sum() / count.sum()
    return float(there.sum()), len(there) / len(corrected), float(hits)
