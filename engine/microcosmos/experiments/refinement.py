"""Refinement of one creature by gradients, within its cell of an archive.

A step is along the slope of fitness, or along its part that is orthogonal to the slopes of all
descriptors, which then stay the same to first order. Trials of several lengths are evaluated
as in a search; the best one in the same cell is the next creature.
"""

import json
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
from ..search.parts.records import identity, measurement
from . import table_file
from .table_file import Table

TRIAL_RATIO = 4.0
"""Each trial is shorter than the one before by this factor."""


@dataclass(frozen=True)
class Trials:
    """Genes to try, and the distance of each from the present ones."""

    genes: np.ndarray
    """(trial, gene)."""
    lengths: np.ndarray
    """(trial,)."""
    slope: float | None = None
    """Length of the slope of fitness; None if the present genes alone are tried."""

    def gain_ratio(self, before: float, fitness: np.ndarray) -> float | None:
        """Return the gain of the shortest trial over the gain that the slope predicts."""
        if not self.slope:
            return None
        # Even trials follow the whole slope, odd ones its part that keeps descriptors.
        shortest = 2 * ((len(self.lengths) - 1) // 2)
        predicted = self.lengths[shortest] * self.slope
        ratio = (float(fitness[shortest]) - before) / predicted
        return ratio if np.isfinite(ratio) else None


@dataclass(frozen=True)
class State:
    """The present creature."""

    genes: np.ndarray
    fitness: float
    length: float
    """Length of the longest trial of the next step."""
    table: Table

    @property
    def generation(self) -> int:
        """Completed steps, including the first measurement of the creature."""
        return self.table.generation


@dataclass(frozen=True)
class Refinement:
    """A refinement, whose generations are steps; an `Experiment`."""

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
    identity_template: Mapping[str, Any]
    encoding: Encoding
    parent: str
    """The creature's name."""
    provenance: Mapping[str, Any] | None
    """Provenance of the creature, if known."""
    device: str
    feasible: bool = False
    """True if a trial at a limit, too fast or pushing itself is refused."""
    measures: tuple[str, ...] = search.MEASURES
    plugins: Mapping[str, Any] = field(default_factory=dict)
    """Versions of the plug-ins among the measures."""

    def init(self) -> State:
        genes = np.asarray(genes_of(take(self.genotype, 0)))
        return State(genes, -np.inf, self.length, Table(0, (), (self.device,)))

    def done(self, state: State) -> bool:
        return state.generation > self.steps

    def advance(
        self, state: State, stop: Callable[[], bool] = search.never
    ) -> tuple[State, Report]:
        """Measure the creature, or take one step."""
        tried, before = self._trials(state, stop), state.fitness
        results = search.evaluate_blocks(
            self.evaluate_block, self._genotypes(tried.genes), block=self.block, stop=stop
        )
        if self.feasible and state.table.rows:  # The creature as it is counts in any case.
            results = search.judged(results)
        best = self._best(state, results)
        if best is None:
            row, length = _unchanged(state), state.length / TRIAL_RATIO
        else:
            row = self._row(state, results, best, tried.genes[best])
            longest = 0 < tried.lengths[best] == tried.lengths[0]
            length = state.length * (2.0 if longest else 1.0)
            state = replace(
                state, genes=tried.genes[best], fitness=float(results.fitness[best])
            )
        agreement = tried.gain_ratio(before, np.asarray(results.fitness))
        row = replace(row, values={**row.values, "slope": tried.slope, "agreement": agreement})
        state = replace(state, length=length, table=state.table.grown((row,)))
        return state, self._report(state, row)

    def save(self, state: State) -> bytes:
        arrays = {
            "next": {
                "genes": state.genes,
                "fitness": np.float64(state.fitness),
                "length": np.float64(state.length),
            }
        }
        return table_file.save(self.spec, state.table, arrays)

    def restore(self, data: bytes, *, other_device: bool = False) -> State:
        table = table_file.restore(self.spec, self.device, data, other_device=other_device)
        after = file.load(data)[0]["next"]
        return State(after["genes"], float(after["fitness"]), float(after["length"]), table)

    def best(self, state: State) -> dict[str, Any] | None:
        if not state.table.rows:
            return None
        row = state.table.rows[-1]
        found = naming.document(self._identity(state.genes), row.measured, row.provenance)
        # It descends from the creature that was given, and stays under its terms.
        given = json.loads(self.spec)["creature"]
        return found | {name: given[name] for name in ("licence", "credit") if name in given}

    def _trials(self, state: State, stop: Callable[[], bool]) -> Trials:
        if not state.table.rows:
            return Trials(state.genes[None], np.zeros(1))
        slopes = search.evaluate_blocks(
            self.slopes, self._genotypes(state.genes[None]), block=1, stop=stop
        )
        rows = np.asarray(slopes.rows[0], np.float64) * bool(slopes.finite[0])
        trials = trials_along(state.genes, rows, state.length, self.block)
        if isinstance(self.genotype, Vector):
            return replace(trials, genes=np.clip(trials.genes, -1.0, 1.0))
        return trials

    def _best(self, state: State, results: search.Evaluation) -> int | None:
        """Return the fittest feasible trial in the creature's cell; None if it is no fitter."""
        cells = np.asarray(self.cells.of(jnp.asarray(results.measures)))
        home = self._home_cell(state) if state.table.rows else cells[0]
        fitness = np.where((results.status == 0) & (cells == home), results.fitness, -np.inf)
        best = int(np.argmax(fitness))
        return best if fitness[best] > state.fitness else None

    def _genotypes(self, genes: np.ndarray) -> Genotype:
        one = jax.tree.map(jnp.asarray, take(self.genotype, 0))
        return jax.device_get(jax.vmap(lambda row: with_genes(one, row))(jnp.asarray(genes)))

    def _home_cell(self, state: State) -> int:
        measured = state.table.rows[0].measured
        assert measured is not None
        measures = np.array([[measured["measures"][name] for name in self.measures]])
        return int(self.cells.of(jnp.asarray(measures, jnp.float32))[0])

    def _identity(self, genes: np.ndarray) -> dict[str, Any]:
        return identity(self.identity_template, take(self._genotypes(genes[None]), 0))

    def _row(
        self, state: State, results: search.Evaluation, best: int, genes: np.ndarray
    ) -> Row:
        measures: dict[str, float] = dict(
            zip(self.measures, results.measures[best].tolist(), strict=True)
        )
        first = not state.table.rows
        values = {
            "step": state.generation,
            "fitness": float(results.fitness[best]),
            **{name: measures[name] for name in self.names},
        }
        measured = measurement(
            float(results.fitness[best]),
            measures,
            self.names,
            block=self.block,
            room=self.encoding.room,
            device=self.device,
            plugins=self.plugins,
        )
        refined = naming.provenance(
            "refinement",
            generation=state.generation,
            parents=[self.parent],
            seed=(self.provenance or {}).get("seed", 0),
        )
        provenance = self.provenance if first else refined
        whole = self._identity(genes)
        return Row(values, naming.name(whole), naming.canonical(whole), measured, provenance)

    def _report(self, state: State, row: Row) -> Report:
        before: Any = state.table.rows[0].values["fitness"]
        return Report(
            generation=state.generation,
            evaluations=1 + (1 + self.block) * (state.generation - 1),
            infeasible=0,
            best=state.fitness,
            rows=(row,),
            summary={"before": before, "fitness": state.fitness, "length": state.length},
        )


def _unchanged(state: State) -> Row:
    if not state.table.rows:
        raise ValueError("`creature` must be one whose simulation stays finite.")
    last = state.table.rows[-1]
    return replace(last, values={**last.values, "step": state.generation})


def trials_along(genes: np.ndarray, rows: np.ndarray, length: float, count: int) -> Trials:
    """Return trials alternately along the slope of fitness and its part that keeps descriptors.

    `rows` are the slopes of fitness, then of descriptors.
    """
    fitness, descriptors = rows[0], rows[1:]
    directions = np.stack([_unit(fitness), _unit(_orthogonal_to(fitness, descriptors))])
    lengths = length / TRIAL_RATIO ** np.arange((count + 1) // 2)
    trials = genes[None, None] + lengths[:, None, None] * directions[None]
    trials = trials.reshape(-1, len(genes))[:count].astype(genes.dtype)
    return Trials(trials, np.repeat(lengths, 2)[:count], float(np.linalg.norm(fitness)))


def _orthogonal_to(row: np.ndarray, others: np.ndarray) -> np.ndarray:
    others = others[np.abs(others).sum(1) > 0]
    if not len(others):
        return row
    _, sizes, basis = np.linalg.svd(others, full_matrices=False)
    # Slopes of descriptors may depend on each other, and a direction of rounding would be taken
    # off too.
    basis = basis[sizes > 1e-6 * sizes[0]]
    return row - basis.T @ (basis @ row)


def _unit(row: np.ndarray) -> np.ndarray:
    return row / max(float(np.linalg.norm(row)), 1e-30)
