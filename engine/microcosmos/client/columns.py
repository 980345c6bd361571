"""Named columns of numbers, and data frames where pandas is installed."""

from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np


class Columns(Mapping[str, np.ndarray]):
    """Arrays of one length by name."""

    def __init__(self, columns: Mapping[str, Any]):
        self._columns = {name: array(values) for name, values in columns.items()}

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), ()))
        return f"<{rows} rows of {', '.join(self._columns)}>"

    def to_pandas(self) -> Any:
        """A pandas `DataFrame`; `ImportError` says what to install where there is none."""
        return frame(self._columns)


def array(values: Any) -> np.ndarray:
    """Numbers as an array, None among them as NaN; anything else as objects."""
    if isinstance(values, np.ndarray):
        return values
    kinds = {type(value) for value in values}
    if kinds <= {float, int, type(None)} and kinds != {int}:
        return np.array([np.nan if value is None else value for value in values], float)
    if kinds == {int}:
        return np.array(values, np.int64)
    if kinds == {str}:
        return np.array(values)
    found = np.empty(len(values), object)
    found[:] = list(values)
    return found


def frame(columns: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> Any:
    """A pandas `DataFrame` of columns or of rows."""
    return pandas().DataFrame(columns if isinstance(columns, Mapping) else list(columns))


def pandas() -> Any:
    try:
        return import_module("pandas")
    except ImportError as error:
        raise ImportError("Data frames need pandas: pip install pandas") from error
