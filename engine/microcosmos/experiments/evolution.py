"""Search with an archive: emit, evaluate, insert, tell.

With emitters that draw parents from the archive it is MAP-Elites (Mouret and Clune,
arXiv:1504.04909, 2015); with a population of its own the archive only looks on.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import search
from ..archive.report import Report
from ..genomes import Genotype
from . import archive_file, lineage, reevaluation
from .offspring import Programs, next_offspring, refuse_lacking
from .state import CURVES, ENDS, MAX_DIVERGED, Diverged, Plan, State, start
from .summary import summary


@dataclass(frozen=True)
class Evolution:
    """A search that fills an archive, driven by whoever holds it."""

    plan: Plan
    programs: Programs
    repeats: reevaluation.Programs | None = None
    """What evaluates elites again, if they are."""

    def init(self) -> State:
        """Before the first generation; raises `ValueError` where device_of are lacking."""
        refuse_lacking(self.plan)
        return start(self.plan)

    def done(self, state: State) -> bool:
        """Whether all generations are completed, or a limit was reached."""
        return bool(state.ended) or state.generation >= self.plan.generations

    def generation(self, state: State) -> int:
        """Generations completed."""
        return state.generation

    def advance(
        self, state: State, stop: Callable[[], bool] = search.never
    ) -> tuple[State, Report]:
        """One generation: emit children, evaluate them by blocks, insert, tell the emitters.

        Raises `Stopped` where `stop()` says so between blocks; `state` stays as it was.
        """
        programs, spent = self.programs, state.device_seconds
        offspring = next_offspring(self.plan, programs, state, stop)
        children, taught, began = offspring.children, offspring.taught, offspring.began
        evaluation = search.evaluate_blocks(
            programs.evaluate_block, children.genotypes, block=self.plan.block, stop=stop
        )
        seconds = (time.monotonic() - began) * jax.local_device_count()
        candidates = _candidates(state.generation + 1, children, evaluation)
        elites, inserted = programs.insert(state.elites, candidates, state.cells)
        emitters = offspring.kept(
            programs.tell(offspring.emitters, _outcome(candidates, inserted))
        )
        inserted = jax.device_get(inserted)
        clipped = search.clipped(candidates, state.cells)
        slots = np.flatnonzero(inserted.entered)
        news = lineage.record(
            self.plan, state, children, evaluation, inserted.cell[slots], slots, offspring.names
        )
        state = replace(
            state,
            generation=state.generation + 1,
            evaluations=state.evaluations + taught.simulated + len(evaluation.fitness),
            diverged=state.diverged + int(np.count_nonzero(evaluation.status)),
            elites=elites,
            counters=offspring.counters,
            emitters=emitters,
            repeats=programs.forget(state.repeats, inserted.cell, inserted.entered),
            outcomes=np.concatenate([state.outcomes, self._outcomes(inserted)[None]]),
            device_seconds=state.device_seconds + seconds,
            nearest_ancestors=news.nearest_ancestors,
            creatures=news.creatures,
            operators=news.operators,
            device_of=news.device_of,
            lineage=news.lineage,
            quarantine=_set_apart(state, children.genotypes, np.asarray(evaluation.status)),
        )
        state = replace(state, ended=_ended(self.plan, state))
        corrected = (np.nan, np.nan, np.nan)
        if self.repeats and reevaluation.due(self.plan, state):
            state = reevaluation.evaluate(self.plan, self.repeats, state, stop)
            corrected = reevaluation.figures(self.repeats, state)
        row = np.array([*_figures(state), clipped, *corrected])
        state = replace(state, curves=np.concatenate([state.curves, row[None]]))
        report = _report(state, news.elites)
        summarised = summary(
            self.plan,
            state,
            dict(zip(CURVES, row.tolist(), strict=True)),
            state.device_seconds - spent,
            np.asarray(evaluation.status),
        )
        return state, replace(report, summary={**summarised, **taught.summary()})

    def creature(self, state: State, cell: int) -> dict[str, Any]:
        """The creature file of a cell's elite."""
        return lineage.document(self.plan, state, cell)

    def best(self, state: State) -> dict[str, Any] | None:
        """The creature file of the fittest elite, or None while there is none."""
        occupied = np.asarray(state.elites.occupied)
        if not occupied.any():
            return None
        fitness = np.where(occupied, np.asarray(state.elites.fitness), -np.inf)
        return self.creature(state, int(np.argmax(fitness)))

    def save(self, state: State) -> bytes:
        """The archive file, from which the run can also be taken up again."""
        return archive_file.save(self.plan, state)

    def restore(self, data: bytes, *, other_device: bool = False) -> State:
        """The state in an archive file of the same spec.

        Raises `ValueError` for another spec or format, and its subclass `OtherDevice` for
        another kind of device unless `other_device` allows it: from there on bits may
        differ, and the file says so.
        """
        return archive_file.restore(self.plan, data, other_device=other_device)

    def _outcomes(self, inserted: search.Inserted) -> np.ndarray:
        """The row of `OUTCOMES` of each emitter."""
        slots = [emitter.slots for emitter in self.plan.emitters]
        ends = np.cumsum(slots)[:-1]
        fresh = np.split(np.asarray(inserted.entered & inserted.fresh), ends)
        better = np.split(np.asarray(inserted.entered & ~inserted.fresh), ends)
        return np.array(
            [[n, a.sum(), b.sum()] for n, a, b in zip(slots, fresh, better, strict=True)]
        )


def _candidates(
    generation: int, children: search.Children, evaluation: search.Evaluation
) -> search.Elites:
    batch = len(evaluation.fitness)
    return search.Elites(
        occupied=jnp.asarray(evaluation.status == 0),
        fitness=jnp.asarray(evaluation.fitness),
        measures=jnp.asarray(evaluation.measures),
        generation=jnp.full(batch, generation, jnp.int32),
        slot=jnp.arange(batch, dtype=jnp.int32),
        genotypes=children.genotypes,
    )


def _outcome(candidates: search.Elites, inserted: search.Inserted) -> search.Outcome:
    return search.Outcome(
        genotypes=candidates.genotypes,
        fitness=candidates.fitness,
        measures=candidates.measures,
        sound=candidates.occupied,
        cell=inserted.cell,
        entered=inserted.entered,
        fresh=inserted.fresh,
        improvement=inserted.improvement,
    )


def _set_apart(state: State, genotypes: Genotype, status: np.ndarray) -> Diverged:
    failed = np.flatnonzero(status)
    new = Diverged(
        generation=np.full(len(failed), state.generation + 1, np.int32),
        slot=failed.astype(np.int32),
        status=status[failed].astype(np.int32),
        genotypes=jax.tree.map(lambda x: np.asarray(x)[failed], genotypes),
    )
    return jax.tree.map(
        lambda a, b: np.concatenate([a, b])[-MAX_DIVERGED:], state.quarantine, new
    )


def _ended(plan: Plan, state: State) -> int:
    """The place in `ENDS` of the limit that the state has reached, 0 where it has none."""
    limits, elites = plan.limits, state.elites
    best = np.max(np.where(elites.occupied, elites.fitness, -np.inf))
    reached = {
        "evaluations": state.evaluations >= limits.evaluations,
        "fitness": best >= limits.fitness,
        "device_hours": state.device_seconds >= 3600 * limits.device_hours,
    }
    return next((ENDS.index(name) for name, there in reached.items() if there), 0)


def _figures(state: State) -> tuple[float, ...]:
    """The first columns of `CURVES` for the present archive, summed in double precision."""
    occupied = np.asarray(state.elites.occupied)
    fitness = np.asarray(state.elites.fitness, np.float64)[occupied]
    best, mean = (fitness.max(), fitness.mean()) if len(fitness) else (0.0, 0.0)
    coverage = len(fitness) / len(occupied)
    return fitness.sum(), coverage, best, mean, state.evaluations, state.diverged


def _report(state: State, elites: tuple) -> Report:
    values = dict(zip(CURVES, state.curves[-1].tolist(), strict=True))
    return Report(
        generation=state.generation,
        qd_score=values["qd_score"],
        coverage=values["coverage"],
        best=values["best"],
        mean=values["mean"],
        evaluations=state.evaluations,
        diverged=state.diverged,
        elites=elites,
    )
