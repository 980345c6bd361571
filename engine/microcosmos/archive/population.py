"""Creatures as columns: names, fitness, generations and measures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from . import measured
from .file import load

Column = np.ndarray | Sequence[float | None]


@dataclass(frozen=True, eq=False)
class Creatures:
    """Columns with an entry for each creature, in the order of their names."""

    names: np.ndarray
    """SHA-256 in hexadecimal digits as bytes, each once."""
    fitness: np.ndarray
    generation: np.ndarray
    """Generation in which each first entered."""
    measures: Mapping[str, np.ndarray]
    given: np.ndarray
    """Row of each creature in the given columns."""

    def __len__(self) -> int:
        return len(self.names)

    def among(self, names: Sequence[str]) -> "Creatures":
        """Return the creatures that are among these names."""
        kept = np.isin(self.names, np.array(names, "S64"))
        columns = {name: column[kept] for name, column in self.measures.items()}
        rest = (self.fitness[kept], self.generation[kept], columns, self.given[kept])
        return Creatures(self.names[kept], *rest)


def creatures(
    names: Sequence[str],
    fitness: Column,
    generation: np.ndarray | Sequence[int],
    measures: Mapping[str, Column],
) -> Creatures:
    """Sort columns by name; of a creature that entered several times, keep the first entry.

    A missing value is NaN.
    """
    listed, entered = np.array(names, "S64"), np.array(generation, np.int64)
    order = np.lexsort((entered, listed))
    new = np.ones(len(order), bool)
    new[1:] = listed[order][1:] != listed[order][:-1]
    rows = order[new]
    columns = {name: np.array(column, np.float32)[rows] for name, column in measures.items()}
    heights = np.array(fitness, np.float32)[rows]
    return Creatures(listed[rows], heights, entered[rows], columns, rows)


def of_file(data: bytes) -> Creatures:
    """Return the elites of an archive file with all measures.

    Raises `ValueError` for a file of a run without an archive.
    """
    tree, attributes = load(data)
    if "archive" not in tree:
        raise ValueError("an archive is needed, as searches have; got a table")
    archive = tree["archive"]
    return creatures(
        [bytes(row).hex() for row in archive["creature"]],
        archive["fitness"],
        archive["generation"],
        measured.columns(tree, attributes),
    )
