"""Archive files for figures, read with NumPy alone."""

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ...archive import file
from ...archive.export import tessellation
from ...spec import Descriptor, Neuroevolution, PluginVersion, QualityDiversity, parse

Search = QualityDiversity | Neuroevolution
"""The specs whose runs fill an archive."""


class Described(Protocol):
    """A run as captions and labels need it: an archive, or a run's record of statistics."""

    @property
    def spec(self) -> Any: ...
    @property
    def curves(self) -> Any: ...
    @property
    def version(self) -> str: ...
    @property
    def devices(self) -> tuple[str, ...]: ...


def plugins_of(spec: Search) -> dict[str, PluginVersion]:
    """Return versions of the plug-ins among the measures, by name."""
    task = spec.task
    return spec.archive.plugins | ({task.fitness: task.plugin} if task.plugin else {})


@dataclass(frozen=True, eq=False)
class Archive:
    """The elites of a run, its curves and its lineage."""

    spec: Search
    version: str
    devices: tuple[str, ...]
    """Kinds of device that computed it, in order."""
    measures: dict[str, np.ndarray]
    """Measures of each elite, by name."""
    cells: np.ndarray
    """The cell of each elite; with a container its place, which does not tell where it lies."""
    fitness: np.ndarray
    generation: np.ndarray
    centroids: np.ndarray | None
    """(cell, axis) from 0 to 1 on the axes' own scales; None for a grid or a container."""
    curves: dict[str, np.ndarray]
    lineage: dict[str, np.ndarray]
    """Columns with an entry for each creature that entered the archive, in order."""
    operators: tuple[str, ...]

    @property
    def axes(self) -> tuple[Descriptor, ...]:
        return self.spec.archive.descriptors

    @property
    def pool(self) -> bool:
        """Whether a container numbers the places of elites, instead of cells."""
        return self.spec.archive.container is not None

    @property
    def best(self) -> int:
        """Return the row of the fittest elite."""
        return int(np.argmax(self.fitness))

    @cached_property
    def document(self) -> dict[str, Any]:
        return self.spec.model_dump(mode="json")

    def row(self, cell: int | None) -> int:
        """Return the row of a cell's elite; None: the fittest. `ValueError` if empty."""
        if cell is None:
            return self.best
        found = np.flatnonzero(self.cells == cell)
        if not len(found):
            raise ValueError(
                f"`cell` must be one of the {len(self.cells)} that have an elite, from "
                f"{self.cells.min()} to {self.cells.max()}; got {cell}"
            )
        return int(found[0])


def read(data: bytes) -> Archive:
    """Return the archive in a run's file. Raises `ValueError` if it is missing or empty."""
    tree, attributes = file.load(data)
    spec = parse(json.loads(attributes["spec"]))
    if "archive" not in tree or not isinstance(spec, Search):
        table = f"the table of {spec.experiment!r}"
        raise ValueError(f"an archive is needed, as searches have; got {table}")
    archive = tree["archive"]
    if not len(archive["cell"]):
        raise ValueError("an archive with an elite is needed, got one without")
    names = json.loads(attributes["measures"])
    return Archive(
        spec=spec,
        version=attributes["version"],
        devices=tuple(json.loads(attributes["device"])),
        measures=dict(zip(names, archive["measures"].T, strict=True)),
        cells=archive["cell"],
        fitness=archive["fitness"].astype(float),
        generation=archive["generation"],
        centroids=tessellation(archive, json.loads(attributes["spec"])["archive"]),
        curves=tree["curves"],
        lineage=tree["lineage"],
        operators=tuple(json.loads(attributes["operators"])),
    )
