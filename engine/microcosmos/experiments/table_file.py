"""Runs whose result is a table, and their file, which is also their checkpoint.

The layout is described in `docs/formats.md`. It holds no clock, host, run or attempt, so that
a computed table (not one of measured times) gives the same bytes every time.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..archive import file
from ..archive.report import Report, Row
from ..search import never
from ..version import VERSION
from .resume_check import devices_of


@dataclass(frozen=True)
class Table:
    """The rows so far: the state of such a run."""

    generation: int
    rows: tuple[Row, ...]
    devices: tuple[str, ...]
    """Kinds of device that computed it, the present one last."""

    def grown(self, rows: tuple[Row, ...]) -> "Table":
        """Return the table with the rows of one more generation."""
        return replace(self, generation=self.generation + 1, rows=self.rows + rows)


@dataclass(frozen=True)
class TableRun:
    """An experiment whose generations add rows to a table."""

    spec: str
    """The whole spec as JSON."""
    device: str
    generations: int
    rows: Callable[[int, Callable[[], bool]], tuple[Row, ...]]
    """The rows of a generation, counted from 0; raises `Stopped` if asked to stop."""
    report: Callable[[Table, tuple[Row, ...]], Report]
    """The report of a table and its newest rows."""

    def init(self) -> Table:
        return Table(0, (), (self.device,))

    def done(self, state: Table) -> bool:
        return state.generation >= self.generations

    def advance(self, state: Table, stop: Callable[[], bool] = never) -> tuple[Table, Report]:
        rows = self.rows(state.generation, stop)
        state = state.grown(rows)
        return state, self.report(state, rows)

    def save(self, state: Table) -> bytes:
        return save(self.spec, state)

    def restore(self, data: bytes, *, other_device: bool = False) -> Table:
        return restore(self.spec, self.device, data, other_device=other_device)

    def best(self, state: Table) -> None:
        return None  # Rows do not compete.


def save(spec: str, table: Table, arrays: Mapping[str, Any] | None = None) -> bytes:
    """Write rows as columns: numbers as float64, words as bytes, identities as one JSON text.

    `arrays` are further groups of the file.
    """
    rows, names = table.rows, list(table.rows[0].values) if table.rows else []
    whole = [
        {"creature": row.creature, "measured": row.measured, "provenance": row.provenance}
        | {"identity": row.identity and row.identity.decode()}
        for row in rows
    ]
    # The columns are for readers of other languages; the run itself resumes from the JSON,
    # which keeps words, nulls and types.
    tree = {
        **(arrays or {}),
        "table": {name: _column([row.values[name] for row in rows]) for name in names},
        "loop": {
            "generation": np.int64(table.generation),
            "rows": _text([dict(row.values) for row in rows]),
            "creatures": _text(whole),
        },
    }
    attributes = {
        "format": file.FORMAT,
        "version": VERSION,
        "device": json.dumps(list(table.devices)),
        "spec": spec,
        "columns": json.dumps(names),
    }
    return file.dump(tree, attributes)


def restore(spec: str, device: str, data: bytes, *, other_device: bool) -> Table:
    """Return the table in a file of the same spec; raises like `archive_file.restore`."""
    tree, attributes = file.load(data)
    devices = devices_of(spec, device, attributes, other_device)
    loop = tree["loop"]
    values, creatures = (json.loads(bytes(loop[name])) for name in ("rows", "creatures"))
    rows = tuple(
        Row(row, **about | {"identity": about["identity"] and about["identity"].encode()})
        for row, about in zip(values, creatures, strict=True)
    )
    return Table(int(loop["generation"]), rows, devices)


def _column(values: list[Any]) -> np.ndarray:
    if all(isinstance(value, int | float | None) for value in values):
        return np.array([np.nan if value is None else value for value in values], np.float64)
    return np.array([str(value).encode() for value in values])


def _text(document: Any) -> np.ndarray:
    return np.frombuffer(json.dumps(document).encode(), np.uint8)
