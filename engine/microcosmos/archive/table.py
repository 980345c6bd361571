"""Reader of the result of a run without an archive."""

import json
from dataclasses import dataclass
from typing import Any

from .file import load


@dataclass(frozen=True)
class Table:
    """Rows of flat values, and their kind of experiment."""

    experiment: str
    rows: list[dict[str, Any]]


def read_table(data: bytes) -> Table:
    """The table in a run's file. Raises `ValueError` if it has none."""
    tree, attributes = load(data)
    loop = tree.get("loop", {})
    if "rows" not in loop:
        raise ValueError(
            "a table is needed, as sweeps, measurements and foldings have; got an archive"
        )
    experiment = json.loads(attributes["spec"])["experiment"]
    return Table(experiment, json.loads(bytes(loop["rows"])))
