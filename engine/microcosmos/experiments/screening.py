"""Screened offspring: rounds of candidates are predicted, and the promising are simulated.

It is surrogate-assisted illumination (Gaier, Asteroth and Mouret, Evol. Comput. 26, 381, 2018):
candidates of a round descend from the elites and from the best predicted of the rounds before.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .. import neat, search
from ..genomes import Genotype, Graph
from ..search.screening import Predicted, with_errors
from ..search.screening import learned as with_evaluations
from .state import PREDICTIONS, Plan, Screened, State


@dataclass(frozen=True)
class Programs:
    """The compiled parts of screening."""

    emit: Callable[..., tuple[search.Children, neat.Counters]]
    """Candidates of a round, from an archive, counters, a generation, the round and the emitter
    of each."""
    describe: Callable[[Genotype], search.screening.Described]
    """Descriptions of a block of genotypes."""
    predict: Callable[..., Predicted]
    """Predictions for descriptions, from a model and cells."""
    best: Callable[..., tuple[Int[Array, "chosen"], Float[Array, "cell"]]]
    outputs: Callable[[search.Evaluation], Float[np.ndarray, "row output"]]
    """What the model learns of evaluations."""


@dataclass(frozen=True)
class Pool:
    """The candidates of all rounds, in NumPy arrays."""

    children: search.Children
    """Parents are cells of the archive before the first round."""
    predicted: Predicted
    emitter: Int[np.ndarray, "candidate"]


def candidates(
    plan: Plan,
    programs: Programs,
    inserts: tuple[Callable[..., tuple[search.Elites, search.Inserted]], ...],
    state: State,
    emitter: Int[np.ndarray, "slot"],
    stop: Callable[[], bool],
) -> tuple[Pool, neat.Counters]:
    """Return the candidates of all rounds, and the counters after their genes.

    Takes the number of each slot's emitter, in ascending order. The first of `inserts` keeps
    the archive that it is given, the second may overwrite it.
    """
    assert plan.screening is not None
    elites, counters, parts = state.elites, state.counters, []
    of = np.repeat(emitter, plan.screening.candidates)
    ancestors = np.arange(plan.cell_count, dtype=np.int32)
    for number in range(plan.screening.rounds):
        children, counters = programs.emit(
            elites, counters, jnp.asarray(state.generation), jnp.asarray(number), of
        )
        children = jax.device_get(children)
        parents = np.asarray(children.parents)
        parents = np.where(parents < 0, parents, ancestors[parents])
        children = eqx.tree_at(lambda one: one.parents, children, parents)
        predicted = predict(plan, programs, state, children.genotypes, stop)
        parts.append((children, predicted))
        if number + 1 < plan.screening.rounds:
            likely = predicted.feasible > 0.5
            rows = search.candidates(
                state.generation + 1,
                children.genotypes,
                jnp.asarray(predicted.fitness),
                jnp.asarray(predicted.measures),
                jnp.asarray(likely),
            )
            elites, inserted = inserts[number > 0](elites, rows, state.container)
            entered = np.asarray(inserted.entered)
            ancestors[np.asarray(inserted.cell)[entered]] = parents[entered, 0]
    children, predicted = jax.tree.map(lambda *rows: np.concatenate(rows), *parts)
    return Pool(children, predicted, np.tile(of, plan.screening.rounds)), counters


def chosen(
    plan: Plan,
    programs: Programs,
    state: State,
    pool: Pool,
    counters: neat.Counters,
    emitter: Int[np.ndarray, "slot"],
) -> tuple[search.Children, neat.Counters]:
    """Return the children to simulate, and the counters after their genes.

    Each emitter fills its slots with its own candidates: the last of them unscreened, from the
    first of the first round.
    """
    assert plan.screening is not None
    height, rows = search.screening.heights(state.elites), []
    for number, slots in enumerate(np.bincount(emitter).tolist()):
        own, free = pool.emitter == number, round(plan.screening.unscreened * slots)
        places, height = programs.best(
            pool.predicted, height, jnp.asarray(own), slots - free, plan.batch
        )
        found, taken = np.asarray(places)[: slots - free], np.zeros(len(own), bool)
        taken[found] = True
        rows += [found, np.flatnonzero(own & ~taken)[:free]]
    children = jax.tree.map(lambda x: x[np.concatenate(rows)], pool.children)
    if not isinstance(children.genotypes, Graph):
        return children, counters
    genotypes, counters = neat.compacted(children.genotypes, state.counters)
    return eqx.tree_at(lambda one: one.genotypes, children, genotypes), counters


def predict(
    plan: Plan,
    programs: Programs,
    state: State,
    genotypes: Genotype,
    stop: Callable[[], bool],
) -> Predicted:
    """Return predictions for genotypes, in NumPy."""
    assert state.screened is not None
    described = _described(plan, programs, genotypes, stop)
    return jax.device_get(
        programs.predict(described, state.screened.model.predictor, state.container)
    )


def learn(
    plan: Plan,
    programs: Programs,
    state: State,
    genotypes: Genotype,
    evaluation: search.Evaluation,
    cells: Int[np.ndarray, "row"],
) -> Screened:
    """Return what is known after a generation, and a row of `PREDICTIONS` about it.

    `cells` are those of the evaluations; the number of cells stands for none.
    """
    assert plan.screening is not None
    assert state.screened is not None
    model, figures = state.screened.model, np.full(len(PREDICTIONS), np.nan)
    described = _described(plan, programs, genotypes, search.never)
    outputs = programs.outputs(evaluation)
    finite = np.all(np.isfinite(outputs), 1) & np.asarray(evaluation.status != 1)
    if model.ready:
        found = jax.device_get(programs.predict(described, model.predictor, state.container))
        figures = _figures(found, evaluation, cells, plan.cell_count)
        model = with_errors(model, found.outputs[finite], outputs[finite])
    inputs = np.asarray(described.inputs)[finite]
    model = with_evaluations(plan.screening.regression, model, inputs, outputs[finite])
    rows = np.concatenate([state.screened.predictions, figures[None]])
    return Screened(model, rows)


def _described(
    plan: Plan, programs: Programs, genotypes: Genotype, stop: Callable[[], bool]
) -> search.screening.Described:
    """Return the descriptions of genotypes, computed on all devices.

    A description is so short that a block of a whole generation costs less than smaller ones.
    """
    return search.evaluate_blocks(programs.describe, genotypes, block=plan.batch, stop=stop)


def _figures(
    found: Predicted, evaluation: search.Evaluation, cells: np.ndarray, count: int
) -> Float[np.ndarray, "prediction"]:
    feasible, placed = np.asarray(evaluation.status) == 0, cells < count
    errors = np.asarray(found.fitness, float) - np.asarray(evaluation.fitness)
    right = np.asarray(found.cell)[placed] == cells[placed]
    return np.array(
        [
            np.sqrt(np.mean(errors[feasible] ** 2)) if feasible.any() else np.nan,
            np.mean(right) if placed.any() else np.nan,
            np.mean(np.asarray(found.feasible, float)),
        ]
    )


def summary(screened: Screened) -> dict[str, Any]:
    """Return the figures for the report of a generation; empty without predictions."""
    names = (f"predicted: {name}" for name in PREDICTIONS)
    pairs = zip(names, screened.predictions[-1].tolist(), strict=True)
    return {name: value for name, value in pairs if np.isfinite(value)}
