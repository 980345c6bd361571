"""Folding: filaments that learn rest shapes of pictures by gradients."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import naming, search
from ..archive import file
from ..archive.report import Report, Row
from ..genomes import Vector
from ..search.parts.records import identity
from ..search.state_file import filled, leaves
from . import table_file
from .table_file import Table


@dataclass(frozen=True)
class State:
    """The folds, and the losses so far."""

    folds: search.folding.Fold
    losses: np.ndarray
    """(update, fold) loss before each update."""
    table: Table
    """One row a fold, once all updates are done."""

    @property
    def generation(self) -> int:
        return self.table.generation


@dataclass(frozen=True)
class Folding:
    """Folds, whose generations are updates of all; an `Experiment`."""

    spec: str
    """The whole spec as JSON."""
    names: tuple[str, ...]
    """Names of the pictures."""
    start: search.folding.Fold
    """Before the first update."""
    program: Callable[[search.folding.Fold], tuple[search.folding.Fold, Any]]
    updates: int
    block: int
    identity_template: Mapping[str, Any]
    """The identity of all creatures but for their genes."""
    device: str

    def init(self) -> State:
        losses = np.zeros((0, len(self.names)), np.float32)
        return State(self.start, losses, Table(0, (), (self.device,)))

    def done(self, state: State) -> bool:
        return state.generation >= self.updates

    def advance(
        self, state: State, stop: Callable[[], bool] = search.never
    ) -> tuple[State, Report]:
        folds, losses = search.evaluate_blocks(
            self.program, state.folds, block=self.block, stop=stop
        )
        losses = np.concatenate([state.losses, np.asarray(losses)[None]])
        state = replace(state, folds=folds, losses=losses)
        last = state.generation + 1 == self.updates
        rows = tuple(self._row(state, i) for i in range(len(self.names))) if last else ()
        state = replace(state, table=state.table.grown(rows))
        return state, self._report(state, rows)

    def save(self, state: State) -> bytes:
        folds = state.folds
        arrays = {
            "curves": {"loss": state.losses},
            "folds": {"genes": folds.best, "loss": folds.least, "picture": folds.picture},
            "next": {
                "genes": folds.genes,
                "rate_share": folds.rate_share,
                "optimiser": leaves(folds.optimiser),
            },
        }
        return table_file.save(self.spec, state.table, arrays)

    def restore(self, data: bytes, *, other_device: bool = False) -> State:
        table = table_file.restore(self.spec, self.device, data, other_device=other_device)
        tree, _ = file.load(data)
        best, after = tree["folds"], tree["next"]
        folds = search.folding.Fold(
            genes=jnp.asarray(after["genes"]),
            optimiser=filled(self.start.optimiser, after["optimiser"]),
            best=jnp.asarray(best["genes"]),
            least=jnp.asarray(best["loss"]),
            rate_share=jnp.asarray(after["rate_share"]),
            picture=jnp.asarray(best["picture"]),
        )
        return State(jax.device_get(folds), tree["curves"]["loss"], table)

    def best(self, state: State) -> dict[str, Any] | None:
        """Return the fold with the least loss, or None before the last update."""
        if not state.table.rows:
            return None
        best = int(np.argmin(state.folds.least))
        provenance = state.table.rows[best].provenance
        return naming.document(self._identity(state, best), None, provenance)

    def _identity(self, state: State, fold: int) -> dict[str, Any]:
        return identity(self.identity_template, Vector(jnp.asarray(state.folds.best[fold])))

    def _row(self, state: State, fold: int) -> Row:
        course, whole = state.losses[:, fold], self._identity(state, fold)
        row = {
            "picture": self.names[fold],
            "first": _finite(course[0]),
            "last": _finite(course[-1]),
            "least": _finite(state.folds.least[fold]),
            "empty": float(np.mean(np.square(state.folds.picture[fold], dtype=np.float64))),
            "failed": int(np.count_nonzero(~np.isfinite(course))),
        }
        operator = f"folding into {self.names[fold]}"
        provenance = naming.provenance(operator, generation=self.updates)
        return Row(row, naming.name(whole), naming.canonical(whole), None, provenance)

    def _report(self, state: State, rows: tuple[Row, ...]) -> Report:
        now = dict(zip(self.names, state.losses[-1].tolist(), strict=True))
        return Report(
            generation=state.generation,
            evaluations=state.losses.size,
            infeasible=int(np.count_nonzero(~np.isfinite(state.losses))),
            rows=rows,
            summary={"loss": float(np.mean(state.losses[-1]))}
            | {f"loss.{name}": value for name, value in now.items()},
        )


def _finite(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None
