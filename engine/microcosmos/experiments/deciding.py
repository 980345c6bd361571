"""Deciding: offspring that would enter the archive compete by means of many evaluations.

A single value that beats an elite may be lucky. As in adaptive sampling (Justesen, Risi and
Mouret, GECCO 2019 Companion, 121) only such offspring are evaluated again, until their mean no
longer enters or is known well enough: its standard error is small (Di Pietro, While and Barone,
CEC 2004, 1254), or the samples are used up. No mean includes the first value, by which they
were chosen.
"""

from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from .. import search
from ..genomes import Genotype
from ..search.reevaluation import Disturbance, disturbance
from .state import Plan, Reevaluation, State

DECIDING = 2**31 - 1
"""Number from which the keys of samples derive; no generation has it."""


@dataclass(frozen=True)
class Programs:
    """The compiled parts of deciding."""

    disturb: Callable[..., Disturbance]
    """The conditions of every offspring, from their genotypes and a sample's number."""
    evaluate_block: Callable[..., search.Evaluation]
    cells_of: Callable[..., Int[Array, "row"]]
    """Cells of offspring, from the cells and their measures."""


@dataclass(frozen=True)
class Decided:
    """The evaluations of a generation, in NumPy arrays."""

    first: search.Evaluation
    """Each creature's first evaluation."""
    mean: search.Evaluation
    """What competes: means where a creature was evaluated again, else the first evaluation."""
    count: Int[np.ndarray, "row"]
    """Evaluations in each mean; 0 without one."""

    def columns(self, slots: np.ndarray) -> dict[str, np.ndarray]:
        """Return the columns of `FirstEvaluations` for some creatures."""
        found = {"fitness": self.first.fitness, "measures": self.first.measures}
        found |= {"count": self.count}
        return {name: np.asarray(column)[slots] for name, column in found.items()}

    @property
    def simulated(self) -> int:
        return len(self.count) + int(self.count.sum())


@dataclass(frozen=True)
class Means:
    """Running means of fitness and measures (Welford 1962), in double precision."""

    count: Int[np.ndarray, "row"]
    values: Float[np.ndarray, "row value"]
    """Fitness, then the measures."""
    squares: Float[np.ndarray, "row value"]
    """Sums of squared deviations from the means."""

    def with_sample(self, rows: np.ndarray, found: search.Evaluation) -> "Means":
        """Add a sample of some rows; infeasible ones are only counted."""
        count, values, squares = self.count.copy(), self.values.copy(), self.squares.copy()
        count[rows] += 1
        sample = np.column_stack([found.fitness, found.measures]).astype(float)
        feasible = np.asarray(found.status) == 0
        rows, sample = rows[feasible], sample[feasible]
        step = sample - values[rows]
        values[rows] += step / count[rows, None]
        squares[rows] += step * (sample - values[rows])
        return Means(count, values, squares)

    def exceeds(
        self, max_error: float, span: float, axes: tuple[search.Axis, ...]
    ) -> Bool[np.ndarray, "row"]:
        """Return where the standard error of fitness, relative to its span, or of a descriptor,
        relative to its axis, is above `max_error`; also below two samples."""
        n = np.maximum(self.count, 2)[:, None]
        error = np.sqrt(self.squares / (n - 1) / n)
        beyond = (self.count < 2) | (error[:, 0] > max_error * span)
        for axis in axes:
            mean = self.values[:, 1 + axis.measure]
            # On a log axis errors are relative: d log x = dx / x.
            scale = np.maximum(mean, axis.low) if axis.logarithmic else 1.0
            beyond |= error[:, 1 + axis.measure] > max_error * axis.span * scale
        return beyond


def undecided(evaluation: search.Evaluation) -> Decided:
    """Return evaluations that compete as they are."""
    return Decided(evaluation, evaluation, np.zeros(len(evaluation.fitness), np.int32))


def disturb(
    reevaluation: Reevaluation, key: PRNGKeyArray, genotypes: Genotype, sample: Int[Array, ""]
) -> Disturbance:
    """Return the conditions of every creature, derived from seed, sample and genome.

    So a creature has the same mean whenever and wherever it is evaluated, and a copy of it has
    no second chance.
    """
    sampled = jax.random.fold_in(jax.random.fold_in(key, DECIDING), sample)

    def one(words: Array) -> Disturbance:
        mine = jax.random.fold_in(jax.random.fold_in(sampled, words[0]), words[1])
        return disturbance(reevaluation.spread, reevaluation.size, key=mine)

    return jax.vmap(one)(search.digest(genotypes))


def decide(
    plan: Plan,
    programs: Programs,
    devices: search.Devices,
    state: State,
    genotypes: Genotype,
    first: search.Evaluation,
    stop: Callable[[], bool],
) -> Decided:
    """Evaluate offspring that would enter again, and return what competes.

    A creature that is infeasible in a sample is infeasible. Raises `Stopped` as `advance` does.
    """
    settings = plan.reevaluation
    assert settings is not None
    mean = first
    span, (rows, width) = _span(state.elites, first), first.measures.shape
    means = Means(np.zeros(rows, np.int32), *np.zeros((2, rows, 1 + width)))
    for sample in range(settings.max_samples):
        unsure = means.exceeds(settings.max_error, span, plan.axes)
        unsure |= means.count < settings.samples
        asked = np.flatnonzero(unsure & _would_enter(programs, state, mean))
        if not len(asked):
            break
        changed = programs.disturb(genotypes, jnp.asarray(sample))
        given = jax.tree.map(lambda x, rows=asked: np.asarray(x)[rows], (genotypes, changed))
        found = devices.evaluate(programs.evaluate_block, given, block=plan.block, stop=stop)
        if plan.feasible:
            found = search.judged(found)
        means = means.with_sample(asked, found)
        status = np.array(mean.status)
        status[asked] = found.status
        mean = _competing(first, means, status)
    return Decided(first, mean, means.count)


def _competing(
    first: search.Evaluation, means: Means, status: Int[np.ndarray, "row"]
) -> search.Evaluation:
    """Return the means of feasible creatures that have one, else the first evaluation."""
    known = (means.count > 0) & (status == 0)
    values = means.values.astype(np.float32)
    fitness = np.where(known, values[:, 0], first.fitness)
    measures = np.where(known[:, None], values[:, 1:], first.measures)
    parts = (fitness, measures, status)
    return eqx.tree_at(lambda one: (one.fitness, one.measures, one.status), first, parts)


def _would_enter(
    programs: Programs, state: State, mean: search.Evaluation
) -> Bool[np.ndarray, "row"]:
    """Return which creatures are not below the elite of their cell."""
    elites, mean = jax.device_get((state.elites, mean))
    cell = np.asarray(programs.cells_of(state.container, jnp.asarray(mean.measures)))
    free = ~elites.occupied[cell]
    able = (mean.status == 0) & np.isfinite(mean.fitness)
    able &= np.all(np.isfinite(mean.measures), 1)
    return able & (free | (mean.fitness >= elites.fitness[cell]))


def _span(elites: search.Elites, first: search.Evaluation) -> float:
    """Return the range of fitness in archive and offspring, 0 without any."""
    here, feasible = np.asarray(elites.occupied), np.asarray(first.status) == 0
    found = [np.asarray(elites.fitness)[here], np.asarray(first.fitness)[feasible]]
    values = np.concatenate(found).astype(float)
    values = values[np.isfinite(values)]
    return float(np.ptp(values)) if len(values) else 0.0
