"""Search with an archive: emit, evaluate, insert, tell.

With emitters that draw parents from the archive it is MAP-Elites (Mouret and Clune,
arXiv:1504.04909, 2015); an emitter with its own population only records in it.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import naming, search
from ..archive.report import Elite, Report
from ..genomes import Genotype, take
from . import (
    archive_file,
    breeding,
    deciding,
    epochs,
    fronts,
    lineage,
    reevaluation,
    reporting,
    screening,
)
from .offspring import Offspring, Programs, divided, next_offspring
from .state import ENDS, MAX_INFEASIBLE, Infeasible, Plan, State, start


@dataclass(frozen=True)
class Evolution:
    """A search that fills an archive; an `Experiment`."""

    plan: Plan
    programs: Programs
    repeats: reevaluation.Programs | None = None
    """Programs that reevaluate elites; None: elites are evaluated once."""
    decide: deciding.Programs | None = None
    """Programs of means that decide; None: offspring compete by their first evaluation."""
    devices: search.Devices = field(default_factory=search.LocalDevices)

    @property
    def device(self) -> str:
        return self.plan.device

    def block_programs(self) -> dict[str, Callable[..., Any]]:
        """Return the programs that `devices` evaluate blocks with, by name."""
        found: dict[str, Callable[..., Any]] = {"offspring": self.programs.evaluate_block}
        if self.repeats:
            found["reevaluation"] = self.repeats.evaluate_block
        if self.decide:
            found["deciding"] = self.decide.evaluate_block
        for number, lesson in enumerate(self.programs.lessons):
            if lesson:
                found[f"slopes {number}"] = lesson.slopes
        return found

    def init(self) -> State:
        """Raise `ValueError` if files of initial creatures are missing."""
        named = json.loads(self.plan.spec)["search"].get("initial", [])
        if named and self.plan.initial is None:
            count = f"{len(named)} creatures"
            raise ValueError(f"`search.initial` names {count}, whose files are needed to begin")
        return start(self.plan)

    def first_generation(self) -> list[dict[str, Any]]:
        """Return the files of the creatures that the run evaluates first, without results.

        Offspring that learn first are as they were before. Raise `ValueError` as `init` does.
        """
        state = self.init()
        given = jnp.asarray(state.generation), divided(self.plan, state)
        emitted = self.programs.emit(state.emitters, state.elites, state.counters, *given)
        genotypes = jax.device_get(emitted[0].genotypes)
        return [
            naming.document(
                lineage.identity(self.plan.identity_template, take(genotypes, number)),
                None,
                None,
            )
            for number in range(self.plan.batch)
        ]

    def choose(self, state: State, files: Sequence[Mapping[str, Any]]) -> State:
        """Return the state whose next generations also descend from chosen creatures; see
        `breeding.choose`."""
        return breeding.choose(self.plan, state, files)

    def done(self, state: State) -> bool:
        return bool(state.ended) or state.generation >= self.plan.generations

    def advance(
        self, state: State, stop: Callable[[], bool] = search.never
    ) -> tuple[State, Report]:
        offspring = next_offspring(self.plan, self.programs, self.devices, state, stop)
        program, genotypes = self.programs.evaluate_block, offspring.children.genotypes
        evaluation = self.devices.evaluate(program, genotypes, block=self.plan.block, stop=stop)
        if self.plan.feasible:
            evaluation = search.judged(evaluation)
        decided = deciding.undecided(evaluation)
        if self.decide:
            decided = deciding.decide(
                self.plan, self.decide, self.devices, state, genotypes, evaluation, stop
            )
        seconds = self.devices.seconds() - offspring.began
        after, elites, clipped, inserted = self._inserted(state, offspring, decided)
        after = replace(after, device_seconds=state.device_seconds + seconds)
        cells = np.asarray(inserted.cell)
        after = self._learned(state, after, genotypes, decided.mean, cells)
        after = replace(after, ended=_ended(self.plan, after))
        corrected = (np.nan, np.nan, np.nan)
        if self.repeats and reevaluation.due(self.plan, after):
            after = reevaluation.evaluate(self.plan, self.repeats, self.devices, after, stop)
            corrected = reevaluation.figures(self.repeats, after)
            # Reevaluations count, so they may use up the budget.
            after = replace(after, ended=after.ended or _ended(self.plan, after))
        row = np.array([*reporting.figures(after), clipped, *corrected])
        after = replace(after, curves=np.concatenate([after.curves, row[None]]))
        after = fronts.measured(after)
        seconds = after.device_seconds - state.device_seconds
        summary = reporting.summary(self.plan, after, seconds, np.asarray(decided.mean.status))
        summary |= offspring.summary(inserted) | self.devices.summary()
        return after, reporting.report(after, elites, emptied(state, after.elites), summary)

    def _inserted(
        self, state: State, offspring: Offspring, decided: deciding.Decided
    ) -> tuple[State, tuple[Elite, ...], int, search.Inserted]:
        """Return the state with the offspring recorded, new elites, the number clipped, and
        where the offspring went."""
        programs, children, evaluation = self.programs, offspring.children, decided.mean
        candidates = search.candidates(
            state.generation + 1,
            children.genotypes,
            jnp.asarray(evaluation.fitness),
            jnp.asarray(evaluation.measures),
            jnp.asarray(evaluation.status == 0),
        )
        container = search.refreshed(
            state.container, state.elites, candidates, state.generation + 1
        )
        elites, inserted = self._placed(state.elites, candidates, container, offspring)
        outcome = search.emitters.outcome(candidates, inserted)
        emitters = offspring.without_replaced(programs.tell(offspring.emitters, outcome))
        inserted = jax.device_get(inserted)
        clipped = search.clipped(candidates, container.axes)
        simulated = offspring.results.simulated + decided.simulated
        after, new = lineage.record(
            self.plan, state, children, decided, inserted, offspring.names
        )
        after = lineage.without(after, emptied(state, elites))
        after = replace(
            after,
            generation=state.generation + 1,
            evaluations=state.evaluations + simulated,
            infeasible=state.infeasible + int(np.count_nonzero(evaluation.status)),
            container=container,
            epochs=epochs.recorded(
                state.epochs, container, state.generation + 1, state.elites, elites
            ),
            elites=elites,
            counters=offspring.counters,
            emitters=emitters,
            repeats=programs.forget(
                state.repeats, inserted.cell, inserted.entered, elites.occupied
            ),
            outcomes=np.concatenate(
                [state.outcomes, self._outcomes(offspring.emitter, inserted)[None]]
            ),
            failures=_failures(state, children.genotypes, np.asarray(evaluation.status)),
        )
        return after, new, clipped, inserted

    def _placed(
        self,
        elites: search.Elites,
        candidates: search.Elites,
        container: search.Container,
        offspring: Offspring,
    ) -> tuple[search.Elites, search.Inserted]:
        """Insert the candidates, and credit their parents."""
        # Reevaluation may yet be stopped, and the state has to stay valid.
        insert = self.programs.insert if self.repeats else self.programs.overwrite
        elites, inserted = insert(elites, candidates, container)
        if offspring.from_archive:
            parents = offspring.children.parents[:, 0]
            scores = self.programs.credit(elites, parents, inserted)
            elites = replace(elites, curiosity=scores)
        return elites, inserted

    def _learned(
        self,
        before: State,
        after: State,
        genotypes: Genotype,
        evaluation: search.Evaluation,
        cells: np.ndarray,
    ) -> State:
        """Return the state after its model has learned the evaluations."""
        given = self.programs.screen
        if given is None:
            return after
        learned = screening.learn(self.plan, given, before, genotypes, evaluation, cells)
        return replace(after, screened=learned)

    def creature(self, state: State, cell: int) -> dict[str, Any]:
        """Return the creature file of a cell's elite."""
        return lineage.document(self.plan, state, cell)

    def best(self, state: State) -> dict[str, Any] | None:
        """Return the creature file of the fittest elite, or None while there is none."""
        occupied = np.asarray(state.elites.occupied)
        if not occupied.any():
            return None
        fitness = np.where(occupied, np.asarray(state.elites.fitness), -np.inf)
        return self.creature(state, int(np.argmax(fitness)))

    def save(self, state: State) -> bytes:
        return archive_file.save(self.plan, state)

    def restore(self, data: bytes, *, other_device: bool = False) -> State:
        return archive_file.restore(self.plan, data, other_device=other_device)

    def _outcomes(self, emitter: np.ndarray, inserted: search.Inserted) -> np.ndarray:
        """Return a row of `OUTCOMES` for each emitter, from the emitter of each slot."""
        entered, fresh = np.asarray(inserted.entered), np.asarray(inserted.fresh)
        counts = np.stack([np.ones(len(entered), int), entered & fresh, entered & ~fresh], 1)
        own = np.arange(len(self.plan.emitters))[:, None] == emitter[None]
        return own.astype(int) @ counts


def _failures(state: State, genotypes: Genotype, status: np.ndarray) -> Infeasible:
    failed = np.flatnonzero(status)
    new = Infeasible(
        generation=np.full(len(failed), state.generation + 1, np.int32),
        slot=failed.astype(np.int32),
        status=status[failed].astype(np.int32),
        genotypes=jax.tree.map(lambda x: np.asarray(x)[failed], genotypes),
    )
    return jax.tree.map(
        lambda a, b: np.concatenate([a, b])[-MAX_INFEASIBLE:], state.failures, new
    )


def _ended(plan: Plan, state: State) -> int:
    """Return the index in `ENDS` of the limit that the state has reached, 0 if none."""
    limits, elites = plan.limits, state.elites
    best = np.max(np.where(elites.occupied, elites.fitness, -np.inf))
    reached = {
        "evaluations": state.evaluations >= limits.evaluations,
        "fitness": best >= limits.fitness,
        "device_hours": state.device_seconds >= 3600 * limits.device_hours,
    }
    return next((ENDS.index(name) for name, there in reached.items() if there), 0)


def emptied(before: State, elites: search.Elites) -> tuple[int, ...]:
    """Return the places that lost their elite and have no new one."""
    lost = np.asarray(before.elites.occupied) & ~np.asarray(elites.occupied)
    return tuple(np.flatnonzero(lost).tolist())
