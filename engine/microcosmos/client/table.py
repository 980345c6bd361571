"""The result of a run that is a table: one row for each thing measured."""

from collections.abc import Mapping
from typing import Any

from . import columns


class Table:
    """Rows of values, and a summary of them all."""

    def __init__(self, document: Mapping[str, Any]):
        self.rows: list[dict[str, Any]] = document["rows"]
        self.summary: dict[str, Any] | None = document["summary"]

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        names = list(dict.fromkeys(name for row in self.rows for name in row))
        return f"<{len(self.rows)} rows of {', '.join(names)}>"

    def to_pandas(self) -> Any:
        """A pandas `DataFrame`; `ImportError` says what to install where there is none."""
        return columns.frame(self.rows)
