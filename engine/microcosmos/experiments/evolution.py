"""Evolution: a run of the search loop that fills an archive on the devices of a worker."""

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from typing import Any

import jax
import numpy as np

from .. import naming, search
from ..archive.report import Report
from ..genomes import take
from ..search import loop, state_file
from ..search.loop import Ask, Batch, Plan, State, Turn
from ..search.parts.records import RunFacts, creature_file, identity
from . import archive_file


@dataclass(frozen=True)
class Evolution:
    """A search that fills an archive; an `Experiment`."""

    plan: Plan
    facts: RunFacts
    devices: search.Devices = field(default_factory=search.LocalDevices)

    @property
    def device(self) -> str:
        return self.facts.device

    def block_programs(self) -> dict[str, Callable[..., Any]]:
        """Return the programs that `devices` evaluate blocks with, by name."""
        return {name: one.run for name, one in self.plan.programs.items() if not one.local}

    def init(self) -> State:
        """Return the first state. Raise `ValueError` if a part lacks files that it needs."""
        return loop.start(self.plan, (self.device,))

    def first_generation(self) -> list[dict[str, Any]]:
        """Return the files of the creatures that the run evaluates first, without results.

        Offspring that learn first are as they were before. Raise `ValueError` as `init` does.
        """
        # Parts with programs of their own, such as derivatives, would take their time.
        parts = tuple(part for part in self.plan.parts if not part.programs)
        work = loop.proposed(replace(self.plan, parts=parts), self.init())
        children = loop.drive(work, self._answers()).batch.children
        template = self.facts.identity_template
        return [
            naming.document(identity(template, take(children.genotypes, number)), None, None)
            for number in range(self.plan.batch)
        ]

    def receive(self, state: State, name: str, event: Any) -> State:
        """Return the state after an event for the part of this name; see `loop.received`."""
        return loop.received(self.plan, state, name, event)

    def done(self, state: State) -> bool:
        return bool(state.ended) or state.generation >= self.plan.generations

    def advance(
        self, state: State, stop: Callable[[], bool] = search.never
    ) -> tuple[State, Report]:
        work = loop.generation(self.plan, state, self.devices.seconds)
        turn = loop.drive(work, self._answers(stop))
        return turn.after, self._report(turn)

    def propose(self, state: State) -> Batch:
        """Return the children of the next generation before their evaluation."""
        return loop.drive(loop.proposed(self.plan, state), self._answers()).batch

    def _answers(self, stop: Callable[[], bool] = search.never) -> Callable[[Ask], Any]:
        """Return the function that evaluates what the loop asks for."""
        programs = self.plan.programs

        def answer(ask: Ask) -> Any:
            program = programs[ask.program]
            count = len(jax.tree.leaves(ask.rows)[0])
            # A gradient alone is a block of its own size, see `Program.pads`.
            block = program.block if program.pads else min(program.block, count)
            evaluate = search.evaluate_blocks if program.local else self.devices.evaluate
            return program.after(evaluate(program.run, ask.rows, block=block, stop=stop))

        return answer

    def _report(self, turn: Turn) -> Report:
        """Return the figures of all parts; some are fields of a report."""
        figures: dict[str, Any] = {**turn.figures, **self.devices.summary()}
        own = {one.name: figures.pop(one.name) for one in fields(Report) if one.name in figures}
        return Report(
            generation=turn.number,
            elites=turn.elites,
            emptied=turn.emptied,
            summary=figures,
            **own,
        )

    def creature(self, state: State, cell: int) -> dict[str, Any]:
        """Return the creature file of a cell's elite."""
        return creature_file(self.facts, self.plan, state, cell)

    def best(self, state: State) -> dict[str, Any] | None:
        """Return the creature file of the fittest elite, or None while there is none."""
        occupied = np.asarray(state.elites.occupied)
        if not occupied.any():
            return None
        fitness = np.where(occupied, np.asarray(state.elites.fitness), -np.inf)
        return self.creature(state, int(np.argmax(fitness)))

    @property
    def growing(self) -> tuple[str, ...]:
        """The groups of its file whose rows are only ever appended."""
        return state_file.growing(self.plan)

    def save(self, state: State) -> bytes:
        return archive_file.save(self.plan, self.facts, state)

    def restore(self, data: bytes, *, other_device: bool = False) -> State:
        return archive_file.restore(self.plan, self.facts, data, other_device=other_device)
