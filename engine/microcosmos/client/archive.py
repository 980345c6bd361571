"""The archive of a run: the elite of each cell."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..archive import poses
from ..archive.axes import Axis, cells
from ..archive.export import scaled, unit
from ..bounds import is_whole
from ..exports import arrow, dataset
from ..exports.tables import Column, Elites, bins, placed
from . import columns, drawing
from .connection import Connection
from .creature import Creature

POSE_CELLS = 500
"""Cells of a request: some 5 MB, and an address of at most 4 kB."""


class Archive:
    """Columns with an entry for each filled cell, after a generation."""

    def __init__(self, connection: Connection, run: str, document: Mapping[str, Any]):
        self._connection = connection
        self._columns = document
        self.run = run
        self.generation: int = document["generation"]
        self.kind: str = document["kind"]
        """`grid`, whose cells are numbered in C order over the bins of the axes, `cvt`, or
        `pool`, whose places have numbers that do not tell where an elite lies."""
        self.cells: int = document["cells"]
        """Number of cells, of a pool that of its places."""
        self.coverage: float = document["coverage"]
        """Share of the cells over the axes that are filled, as the run recorded it."""
        self.axes: list[dict[str, Any]] = document["axes"]
        self.recorded: list[dict[str, Any]] = document["recorded"]
        """The measures of the elites, with title, unit and the ends of an axis."""
        self.cell = np.array(document["cell"], np.int32)
        self.fitness = np.array(document["fitness"], np.float32)
        shape = (len(self.cell), len(self.axes))
        self.descriptors = np.array(document["descriptors"], np.float32).reshape(shape)
        """(elite, axis), raw values."""
        self.elite_generation = np.array(document["elite_generation"], np.int32)
        """Generation in which each elite arose."""
        self.creature: list[str] = document["creature"]
        self.trusted: list[bool | None] = document["trusted"]
        """Verdicts of the elites' audits on the server; None without an audit."""
        self.measures = {
            name: columns.array(values).astype(np.float32)
            for name, values in document["measures"].items()
        }

    def __len__(self) -> int:
        return len(self.cell)

    def __repr__(self) -> str:
        best = f", best {self.fitness.max():.4g}" if len(self) else ""
        cells = "places" if self.kind == "pool" else "cells"
        where = f"{len(self)} of {self.cells} {cells} filled at generation {self.generation}"
        return f"<Archive of run {self.run[:8]}: {where}{best}>"

    def _repr_html_(self) -> str | None:
        """Draw a map of a grid or pool of two axes; a notebook shows the `repr` of others."""
        if self.kind == "cvt" or len(self.axes) != 2:
            return None
        cell, fitness = self.cell, self.fitness
        if self.kind == "pool":
            # Numbers of places do not tell where an elite lies
            # (test_an_archive_of_places_is_drawn_where_its_elites_lie).
            axes = [Axis(**axis) for axis in self.axes]
            cell, fitness = _fittest(cells(axes, [*self.descriptors.T]), fitness)
        return drawing.archive_map(self.axes, cell, fitness, repr(self)[1:-1])

    def best(self) -> Creature:
        """Return the fittest elite. Raise `ValueError` if the archive is empty."""
        if not len(self):
            raise ValueError(f"an archive with elites is needed; run {self.run} has none yet")
        return self._nth(int(self.fitness.argmax()))

    def elite(self, cell: int | Sequence[int]) -> Creature:
        """Return the elite of a cell: by number, or in a grid by its bin along each axis."""
        number = self._number(cell)
        rows = np.flatnonzero(self.cell == number)
        if not len(rows):
            raise KeyError(f"cell {cell} is empty; {len(self)} of {self.cells} are filled")
        return self._nth(int(rows[0]))

    def document(self) -> dict[str, Any]:
        """Return the columns as the server sent them, and the `centroids` of Voronoi cells."""
        return {**self._columns, "centroids": self._centroids()}

    def pose_streams(self, cells: Sequence[int]) -> dict[str, bytes]:
        """Return the stored pose streams of the elites of some cells, by creature."""
        path = f"runs/{self.run}/archive/poses"
        streams: dict[str, bytes] = {}
        for first in range(0, len(cells), POSE_CELLS):
            some = ",".join(map(str, cells[first : first + POSE_CELLS]))
            given = {"cells": some, "generation": self.generation}
            data = self._connection.ask("GET", path, params=given).content
            streams |= {poses.decode(one).creature: one for one in poses.unbatched(data)}
        return streams

    def to_pandas(self) -> Any:
        """Return a data frame with pyribs' columns, as `archive.csv` has them, without genes.

        Genes are in the run's file: `microcosmos.to_pandas(run.pull("run.h5"))`.
        """
        return columns.frame(self.columns())

    def to_arrow(self) -> Any:
        """Return a `pyarrow.Table` with a row for each elite, in columns of
        `microcosmos.to_arrow`; raise `ImportError` without pyarrow."""
        return arrow.of_columns(self.elites().columns, self.run)

    def to_xarray(self) -> Any:
        """Return an `xarray.Dataset` over the axes, as `microcosmos.to_xarray` does; raise
        `ImportError` without xarray."""
        return dataset.of_elites(self.elites())

    def elites(self) -> Elites:
        """Return the columns with titles and units."""
        axes = {axis["name"]: axis for axis in self.axes}
        about = {one["name"]: (one["title"], one["unit"] or "1") for one in self.recorded}
        entered = self.elite_generation
        age = (self.generation - entered).astype(np.int32)
        columns_by_name = {
            "creature": Column(self.creature, "SHA-256 of the creature's identity"),
            "cell": Column(
                self.cell, "Place in the container" if self.kind == "pool" else "Cell"
            ),
            "fitness": Column(self.fitness, "Fitness", ""),
            "generation": Column(entered, "Generation of the elite", "generations"),
            "age": Column(age, "Age", "generations"),
        }
        if self.kind == "grid":
            columns_by_name |= bins(self.cell, self.axes)
        for name, values in self.measures.items():
            column = Column(values, *about[name], axis=axes.get(name))
            columns_by_name[placed(name, columns_by_name)] = column
        attributes = {"run": self.run, "generation": self.generation}
        around = self._centroids()
        centroids = None if around is None else np.array(around, np.float32)
        return Elites(self.kind, self.axes, self.cell, columns_by_name, centroids, attributes)

    def _centroids(self) -> list[list[float]] | None:
        if self.kind != "cvt":
            return None
        return self._connection.read(f"runs/{self.run}/archive/centroids")["centroids"]

    def columns(self) -> dict[str, Any]:
        # As `archive.export.columns`: pyribs measures distances of a CVT from 0 to 1.
        place = unit if self.kind == "cvt" else scaled
        places = map(place, self.descriptors.T, self.axes)
        return {
            "objective": self.fitness,
            **{f"measures_{i}": values for i, values in enumerate(places)},
            "threshold": self.fitness,
            **self.measures,
            "generation": self.elite_generation,
            "creature": self.creature,
            "index": self.cell,
        }

    def _nth(self, index: int) -> Creature:
        return Creature(self._connection, self.creature[index])

    def _number(self, cell: Any) -> int:
        bins, number = [axis["bins"] for axis in self.axes], -1
        if is_whole(cell):
            number = int(cell)
        elif self.kind == "grid" and np.shape(cell) == (len(bins),):
            places = zip(cell, bins, strict=True)
            if all(is_whole(place) and 0 <= place < size for place, size in places):
                number = int(np.ravel_multi_index(tuple(cell), bins))
        if not 0 <= number < self.cells:
            shape = f", or a bin along each axis of {bins}" if self.kind == "grid" else ""
            raise ValueError(f"`cell` must be from 0 to {self.cells - 1}{shape}; got {cell}")
        return number


def _fittest(bins: np.ndarray, fitness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return each occupied bin and its best fitness."""
    order = np.argsort(fitness)[::-1]
    occupied, first = np.unique(bins[order], return_index=True)
    return occupied, fitness[order][first]
