"""One creature made fitter by gradients, within its cell of an archive.

A step is along the slope of fitness, or along what is left of it once the slopes of all
descriptors are taken out, so that they stay as they are to first order; trials of several
lengths are evaluated as in a search, and the best that is in the cell still is the next.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import naming, search
from ..archive import file
from ..archive.report import Report, Row
from ..genomes import Encoding, Genotype, Vector, take
from ..search.gradients import genes_of, with_genes
from . import table_file, trials
from .lineage import identity
from .table_file import Table
from .trials import SHRINK


@dataclass(frozen=True)
class State:
    """Where the creature stands."""

    genes: np.ndarray
    fitness: float
    length: float
    """Of the longest trial of the next step."""
    table: Table


@dataclass(frozen=True)
class Refinement:
    """A refinement, driven by whoever holds it: a generation is one step."""

    spec: str
    """The whole spec as JSON."""
    genotype: Genotype
    """The creature's, a batch of one."""
    slopes: Callable[[Genotype], search.Slopes]
    evaluate_block: Callable[[Genotype], search.Evaluation]
    cells: search.Cells
    names: tuple[str, ...]
    """Descriptors."""
    steps: int
    length: float
    block: int
    frame: Mapping[str, Any]
    encoding: Encoding
    parent: str
    """The creature's name."""
    provenance: Mapping[str, Any] | None
    """How it came to be, if that is known."""
    device: str
    measures: tuple[str, ...] = search.MEASURES
    plugins: Mapping[str, Any] = field(default_factory=dict)
    """Versions of the plug-ins among the measures."""

    def init(self) -> State:
        """Before the creature is measured."""
        genes = np.asarray(genes_of(take(self.genotype, 0)))
        return State(genes, -np.inf, self.length, Table(0, (), (self.device,)))

    def done(self, state: State) -> bool:
        """Whether all steps are done."""
        return state.table.generation > self.steps

    def generation(self, state: State) -> int:
        """Steps that are done, the measurement of the creature as it is among them."""
        return state.table.generation

    def advance(
        self, state: State, stop: Callable[[], bool] = search.never
    ) -> tuple[State, Report]:
        """Measure the creature, or take one step.

        Raises `Stopped` where `stop()` says so; `state` stays as it was.
        """
        tried, before = self._trials(state, stop), state.fitness
        found = search.evaluate_blocks(
            self.evaluate_block, self._genotypes(tried.genes), block=self.block, stop=stop
        )
        best = self._best(state, found)
        if best is None:
            row, length = _unchanged(state), state.length / SHRINK
        else:
            row = self._row(state, found, best, tried.genes[best])
            longest = 0 < tried.lengths[best] == tried.lengths[0]
            length = state.length * (2.0 if longest else 1.0)
            state = replace(state, genes=tried.genes[best], fitness=float(found.fitness[best]))
        health = tried.health(before, np.asarray(found.fitness))
        row = replace(row, values={**row.values, **health})
        state = replace(state, length=length, table=state.table.grown((row,)))
        return state, self._report(state, row)

    def save(self, state: State) -> bytes:
        """The table's file, from which the run can also be taken up again."""
        arrays = {
            "next": {
                "genes": state.genes,
                "fitness": np.float64(state.fitness),
                "length": np.float64(state.length),
            }
        }
        return table_file.save(self.spec, state.table, arrays)

    def restore(self, data: bytes, *, other_device: bool = False) -> State:
        """The state in a file of the same spec; raises `ValueError` or `OtherDevice`."""
        table = table_file.restore(self.spec, self.device, data, other_device=other_device)
        try:
            kept = file.load(data)[0]["next"]
            return State(kept["genes"], float(kept["fitness"]), float(kept["length"]), table)
        except KeyError as error:
            raise ValueError(f"a refinement's file must hold {error}, got none") from error

    def best(self, state: State) -> dict[str, Any] | None:
        """The creature file as it stands, or None before it is measured."""
        if not state.table.rows:
            return None
        row = state.table.rows[-1]
        return naming.document(self._identity(state.genes), row.measured, row.provenance)

    def _trials(self, state: State, stop: Callable[[], bool]) -> trials.Trials:
        """The creature as it is, or steps from it."""
        if not state.table.rows:
            return trials.start(state.genes)
        slopes = search.evaluate_blocks(
            self.slopes, self._genotypes(state.genes[None]), block=1, stop=stop
        )
        rows = np.asarray(slopes.rows[0], np.float64) * bool(slopes.sound[0])
        found = trials.along(state.genes, rows, state.length, self.block)
        if isinstance(self.genotype, Vector):
            return replace(found, genes=np.clip(found.genes, -1.0, 1.0))
        return found

    def _best(self, state: State, found: search.Evaluation) -> int | None:
        """The fittest sound trial in the creature's cell, if it is fitter than before."""
        cells = np.asarray(self.cells.of(jnp.asarray(found.measures)))
        home = self._home(state) if state.table.rows else cells[0]
        fitness = np.where((found.status == 0) & (cells == home), found.fitness, -np.inf)
        best = int(np.argmax(fitness))
        return best if fitness[best] > state.fitness else None

    def _genotypes(self, genes: np.ndarray) -> Genotype:
        one = jax.tree.map(jnp.asarray, take(self.genotype, 0))
        return jax.device_get(jax.vmap(lambda row: with_genes(one, row))(jnp.asarray(genes)))

    def _home(self, state: State) -> int:
        measured = state.table.rows[0].measured
        assert measured is not None
        measures = np.array([[measured["measures"][name] for name in self.measures]])
        return int(self.cells.of(jnp.asarray(measures, jnp.float32))[0])

    def _identity(self, genes: np.ndarray) -> dict[str, Any]:
        return identity(self.frame, take(self._genotypes(genes[None]), 0))

    def _row(self, state: State, found: search.Evaluation, best: int, genes: np.ndarray) -> Row:
        measures: dict[str, float] = dict(
            zip(self.measures, found.measures[best].tolist(), strict=True)
        )
        descriptors = {name: measures[name] for name in self.names}
        first = not state.table.rows
        values = {
            "step": state.table.generation,
            "fitness": float(found.fitness[best]),
            **descriptors,
        }
        measured = {
            "fitness": float(found.fitness[best]),
            "descriptors": descriptors,
            "measures": measures,
            "block": self.block,
            "room": list(self.encoding.room) if self.encoding.room else None,
            "device": self.device,
            **({"plugins": dict(self.plugins)} if self.plugins else {}),
        }
        refined = naming.provenance(
            "refinement",
            generation=state.table.generation,
            parents=[self.parent],
            seed=(self.provenance or {}).get("seed", 0),
        )
        provenance = self.provenance if first else refined
        whole = self._identity(genes)
        return Row(values, naming.name(whole), naming.canonical(whole), measured, provenance)

    def _report(self, state: State, row: Row) -> Report:
        before = state.table.rows[0].values["fitness"]
        return Report(
            generation=state.table.generation,
            evaluations=1 + (1 + self.block) * (state.table.generation - 1),
            diverged=0,
            best=state.fitness,
            rows=(row,),
            summary={"before": before, "fitness": state.fitness, "length": state.length},
        )


def _unchanged(state: State) -> Row:
    """Nothing better was found: the creature as it was."""
    if not state.table.rows:
        raise ValueError("`creature` must be one whose simulation stays finite.")
    last = state.table.rows[-1]
    return replace(last, values={**last.values, "step": state.table.generation})
