"""Tables of results: columns and rows, as data frames where pandas is installed."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..exports import tables
from ..exports.run_file import RunFile
from ..exports.tables import Ragged
from ..optional import require


class Columns(dict[str, np.ndarray]):
    """Arrays of one length by name."""

    def __init__(self, columns: Mapping[str, Any]):
        self.update((name, array(values)) for name, values in columns.items())

    def __repr__(self) -> str:
        rows = len(next(iter(self.values()), ()))
        return f"<{rows} rows of {', '.join(self)}>"

    def to_pandas(self) -> Any:
        """Return a pandas `DataFrame`; raise `ImportError` without pandas."""
        return frame(self)


class Table:
    """The result of a run without an archive: `rows` of values, and a `summary`."""

    def __init__(self, document: Mapping[str, Any]):
        self.rows: list[dict[str, Any]] = document["rows"]
        self.summary: dict[str, Any] | None = document["summary"]

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        names = list(dict.fromkeys(name for row in self.rows for name in row))
        return f"<{len(self.rows)} rows of {', '.join(names)}>"

    def to_pandas(self) -> Any:
        """Return a pandas `DataFrame`; raise `ImportError` without pandas."""
        return frame(self.rows)


def array(values: Any) -> np.ndarray:
    """Convert values: numbers with None as NaN, else texts, else objects."""
    if isinstance(values, np.ndarray):
        return values
    kinds = {type(value) for value in values}
    # Whole numbers stay whole; a missing one makes them real, since only those have NaN.
    if kinds <= {float, int, type(None)} and kinds != {int}:
        return np.array([np.nan if value is None else value for value in values], float)
    if kinds == {int}:
        return np.array(values, np.int64)
    return np.array(values) if kinds == {str} else _objects(values)


def _objects(values: Sequence[Any]) -> np.ndarray:
    objects = np.empty(len(values), object)
    objects[:] = list(values)
    return objects


def frame(columns: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> Any:
    """Return a pandas `DataFrame` of columns or of rows."""
    return require("pandas", "pandas").DataFrame(columns)


def lineage(data: bytes) -> Columns:
    """Return every insertion into an archive file, in order: `creature`, its `parents`,
    `operator`, `generation`, `cell`, `fitness`, and the `descriptors` by name.

    Raise `ValueError` if the file holds no archive.
    """
    columns = tables.lineage(RunFile("run", data))
    return Columns({name: listed(column.values) for name, column in columns.items()})


def listed(values: Any) -> Any:
    """Return lists of different lengths as an array of objects."""
    if not isinstance(values, Ragged):
        return values
    ends = np.cumsum(values.counts)
    starts = ends - values.counts
    return _objects([values.items[i:j] for i, j in zip(starts, ends, strict=True)])
