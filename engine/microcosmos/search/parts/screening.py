"""Screened offspring: rounds of candidates are predicted, and the promising are simulated.

It is surrogate-assisted illumination (Gaier, Asteroth and Mouret, Evol. Comput. 26, 381, 2018):
candidates of a round descend from the elites and from the best predicted of the rounds before.
"""

from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from ... import neat
from ...genomes import Genotype, Graph
from ..blocks import evaluate_blocks
from ..emitters import Children
from ..evaluation import Evaluation
from ..insertion import Elites, Inserted, candidates
from ..loop import Ask, Leaf, Part, Program, Turn, slots_of
from ..screening import Described, Model, Predicted, Regression, heights, learned, with_errors
from .records import columns_of

PREDICTIONS = ("fitness_error", "cell_hits", "feasible")
"""Figures of a generation's predictions: root mean square error of the fitness of feasible
creatures, share of creatures in the predicted cell, and mean predicted probability of being
feasible; NaN before the first prediction."""

DESCRIBE = "descriptions"
"""Name of the program that describes candidates."""


@dataclass(frozen=True)
class Settings:
    """Rounds of candidates, and how many are predicted; see `spec.Screening`."""

    rounds: int
    candidates: int
    unscreened: float
    regression: Regression


@dataclass(frozen=True)
class Programs:
    """The compiled parts of screening."""

    emit: Callable[..., tuple[Children, neat.Counters]]
    """Candidates of a round, from an archive, counters, a generation and the round."""
    describe: Callable[[Genotype], Described]
    """Descriptions of a block of genotypes."""
    predict: Callable[..., Predicted]
    """Predictions for descriptions, from a model and cells."""
    best: Callable[..., tuple[Int[Array, "chosen"], Float[Array, "cell"]]]
    outputs: Callable[[Evaluation], Float[np.ndarray, "row output"]]
    """Outputs that the model learns of evaluations."""
    insert: Callable[..., tuple[Elites, Inserted]]
    overwrite: Callable[..., tuple[Elites, Inserted]]
    """As `insert`; the genotypes of the old archive may be overwritten."""


class Screened(eqx.Module):
    """The model, and how well it predicted."""

    model: Model
    predictions: Float[np.ndarray, "generation prediction"]
    """Columns of `PREDICTIONS`."""


@dataclass(frozen=True)
class Pool:
    """The candidates of all rounds, in NumPy arrays."""

    children: Children
    """Parents are cells of the archive before the first round."""
    predicted: Predicted
    emitter: Int[np.ndarray, "candidate"]


def part(settings: Settings, programs: Programs, batch: int) -> Part:
    """Return the part that screens; it describes a generation of `batch` in one block.

    A description is so short that smaller blocks cost more.
    """
    describe = Program(programs.describe, batch, simulates=False, local=True)
    return Part(
        name="screening",
        begin=lambda plan: Screened(
            settings.regression.init(), np.zeros((0, len(PREDICTIONS)))
        ),
        leaves={
            "model": Leaf("", "loop/model"),
            "predictions": columns_of("screening", PREDICTIONS),
        },
        programs={DESCRIBE: describe},
        propose=lambda own, turn: _screened(settings, programs, own, turn),
        learn=lambda own, turn: (_learned(settings, programs, own, turn), turn),
        figures=_figures,
    )


def _screened(
    settings: Settings, programs: Programs, own: Screened, turn: Turn
) -> Generator[Ask, Any, tuple[Screened, Turn]]:
    """Make the children once the model is ready, unless other parents are due."""
    if turn.batch.source is not None or not own.model.ready:
        return own, turn
    pool, counters = yield from _pool(settings, programs, own, turn)
    children, counters = _chosen(settings, programs, turn, pool, counters)
    batch = replace(
        turn.batch,
        children=children,
        emitters=turn.before.emitters,
        counters=counters,
        emitter=slots_of(turn.plan),
    )
    return own, replace(turn, batch=batch)


def _pool(
    settings: Settings, programs: Programs, own: Screened, turn: Turn
) -> Generator[Ask, Any, tuple[Pool, neat.Counters]]:
    """Return the candidates of all rounds, and the counters after their genes.

    The first round keeps the archive of the state; the next may overwrite the virtual one.
    """
    plan, state = turn.plan, turn.before
    elites, counters, parts = state.elites, state.counters, []
    of = np.repeat(slots_of(plan), settings.candidates)
    ancestors = np.arange(plan.cell_count, dtype=np.int32)
    for number in range(settings.rounds):
        children, counters = programs.emit(
            elites, counters, jnp.asarray(state.generation), jnp.asarray(number)
        )
        children = jax.device_get(children)
        parents = np.asarray(children.parents)
        parents = np.where(parents < 0, parents, ancestors[parents])
        children = eqx.tree_at(lambda one: one.parents, children, parents)
        described = yield Ask(children.genotypes, DESCRIBE)
        predicted = _predicted(programs, own, turn, described)
        parts.append((children, predicted))
        if number + 1 < settings.rounds:
            likely = predicted.feasible > 0.5
            rows = candidates(
                turn.number,
                children.genotypes,
                jnp.asarray(predicted.fitness),
                jnp.asarray(predicted.measures),
                jnp.asarray(likely),
            )
            insert = programs.overwrite if number else programs.insert
            elites, inserted = insert(elites, rows, state.container)
            entered = np.asarray(inserted.entered)
            ancestors[np.asarray(inserted.cell)[entered]] = parents[entered, 0]
    children, predicted = jax.tree.map(lambda *rows: np.concatenate(rows), *parts)
    return Pool(children, predicted, np.tile(of, settings.rounds)), counters


def _chosen(
    settings: Settings, programs: Programs, turn: Turn, pool: Pool, counters: neat.Counters
) -> tuple[Children, neat.Counters]:
    """Return the children to simulate, and the counters after their genes.

    Each emitter fills its slots with its own candidates: the last of them unscreened, from the
    first of the first round.
    """
    plan, state = turn.plan, turn.before
    height, rows = heights(state.elites), []
    for number, slots in enumerate(np.bincount(slots_of(plan)).tolist()):
        own, free = pool.emitter == number, round(settings.unscreened * slots)
        places, height = programs.best(
            pool.predicted, height, jnp.asarray(own), slots - free, plan.batch
        )
        screened, taken = np.asarray(places)[: slots - free], np.zeros(len(own), bool)
        taken[screened] = True
        rows += [screened, np.flatnonzero(own & ~taken)[:free]]
    children = jax.tree.map(lambda x: x[np.concatenate(rows)], pool.children)
    if not isinstance(children.genotypes, Graph):
        return children, counters
    # Candidates that are not simulated leave numbers of genes unused.
    genotypes, counters = neat.compacted(children.genotypes, state.counters)
    return eqx.tree_at(lambda one: one.genotypes, children, genotypes), counters


def _predicted(programs: Programs, own: Screened, turn: Turn, described: Described) -> Any:
    """Return the `Predicted`, in NumPy."""
    return jax.device_get(
        programs.predict(described, own.model.predictor, turn.before.container)
    )


def _learned(settings: Settings, programs: Programs, own: Screened, turn: Turn) -> Screened:
    """Return the model after a generation, with a row of `PREDICTIONS` about it.

    It does not ask: a request could be stopped, and the old archive may be overwritten by now.
    """
    evaluation, batch = turn.evaluation, turn.plan.batch
    model, figures = own.model, np.full(len(PREDICTIONS), np.nan)
    genotypes = turn.batch.children.genotypes
    described = evaluate_blocks(programs.describe, genotypes, block=batch)
    outputs = programs.outputs(evaluation)
    finite = np.all(np.isfinite(outputs), 1) & np.asarray(evaluation.status != 1)
    if model.ready:
        predicted = _predicted(programs, own, turn, described)
        cells = np.asarray(turn.settled.inserted.cell)
        figures = _errors(predicted, evaluation, cells, turn.plan.cell_count)
        model = with_errors(model, predicted.outputs[finite], outputs[finite])
    inputs = np.asarray(described.inputs)[finite]
    model = learned(settings.regression, model, inputs, outputs[finite])
    return Screened(model, np.concatenate([own.predictions, figures[None]]))


def _errors(
    predicted: Predicted, evaluation: Evaluation, cells: np.ndarray, count: int
) -> Float[np.ndarray, "prediction"]:
    """Return a row of `PREDICTIONS`; `count` is the number of cells and stands for no cell."""
    feasible, placed = np.asarray(evaluation.status) == 0, cells < count
    errors = np.asarray(predicted.fitness, float) - np.asarray(evaluation.fitness)
    right = np.asarray(predicted.cell)[placed] == cells[placed]
    return np.array(
        [
            np.sqrt(np.mean(errors[feasible] ** 2)) if feasible.any() else np.nan,
            np.mean(right) if placed.any() else np.nan,
            np.mean(np.asarray(predicted.feasible, float)),
        ]
    )


def _figures(own: Screened, turn: Turn) -> dict[str, int | float]:
    """Return the figures of the generation's predictions; empty without any."""
    pairs = zip(PREDICTIONS, own.predictions[-1].tolist(), strict=True)
    return {f"predicted.{name}": value for name, value in pairs if np.isfinite(value)}
