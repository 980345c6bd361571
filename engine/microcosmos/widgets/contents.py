"""The content of a map: elites by cell, their measures, and how they move."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from math import isfinite, prod
from typing import Any, Protocol, runtime_checkable

import numpy as np

from ..archive import file, measured, poses
from ..archive.export import source_bytes, tessellation
from ..archive.measured import described
from ..archive.report import Report
from ..measures import RECORDED
from ..spec import Neuroevolution, QualityDiversity, parse

MOST = 600
"""Largest number of creatures that swim on a map, as on the page; about 6 MB."""

Search = QualityDiversity | Neuroevolution


@runtime_checkable
class Read(Protocol):
    """An archive that was read from a server: `microcosmos.client.Archive`."""

    def document(self) -> dict[str, Any]: ...
    def pose_streams(self, cells: Sequence[int]) -> dict[str, bytes]: ...


@dataclass(frozen=True)
class Shown:
    """One elite, in raw units."""

    fitness: float
    descriptors: tuple[float, ...]
    generation: int
    creature: str
    measures: Mapping[str, float]


@dataclass
class Contents:
    """An archive as the map in a notebook needs it."""

    kind: str
    """`grid`, `cvt` or `pool`."""
    cells: int
    axes: list[dict[str, Any]]
    recorded: list[dict[str, Any]]
    """The measures, with title, unit, and the ends and scale of an axis."""
    centroids: list[list[float]] | None = None
    generation: int = 0
    elites: dict[int, Shown] = field(default_factory=dict)
    """By cell."""
    streams: dict[str, bytes] = field(default_factory=dict)
    """Pose streams by creature."""

    def add(self, report: Report) -> None:
        """Take the elites that a generation brought, and drop those that it removed."""
        self.generation = report.generation
        for cell in report.emptied:
            self.elites.pop(cell, None)
        for one in report.elites:
            values = one.fitness, one.descriptors, one.generation, one.creature
            self.elites[one.cell] = Shown(*values, one.measures)
            if one.poses is not None:
                self.streams[one.creature] = one.poses
        # Streams of replaced elites would fill the memory of a long run.
        present = {one.creature for one in self.elites.values()}
        self.streams = {name: data for name, data in self.streams.items() if name in present}

    def document(self) -> dict[str, Any]:
        """Return the archive in columns, as JSON; a value that is not finite is None."""
        rows = sorted(self.elites.items())
        elites = [one for _, one in rows]
        names = [one["name"] for one in self.recorded]
        return {
            "kind": self.kind,
            "cells": self.cells,
            "axes": self.axes,
            "recorded": self.recorded,
            "centroids": self.centroids,
            "generation": self.generation,
            "cell": [cell for cell, _ in rows],
            "fitness": [one.fitness for one in elites],
            "descriptors": [list(one.descriptors) for one in elites],
            "elite_generation": [one.generation for one in elites],
            "creature": [one.creature for one in elites],
            "measures": {
                name: [finite(one.measures.get(name)) for one in elites] for name in names
            },
        }

    def pose_streams(self, cells: Sequence[int]) -> dict[str, bytes]:
        """Return the known streams of the elites of some cells, by creature."""
        names = [self.elites[cell].creature for cell in cells if cell in self.elites]
        return {name: self.streams[name] for name in names if name in self.streams}


def finite(value: float | None) -> float | None:
    # JSON has no NaN (test_values_that_are_not_finite_are_none_in_json).
    return value if value is not None and isfinite(value) else None


def fittest(document: Mapping[str, Any]) -> list[int]:
    """Return the cells of the fittest elites, at most `MOST`."""
    order = np.argsort(-np.asarray(document["fitness"], float), kind="stable")[:MOST]
    return [document["cell"][i] for i in order]


def empty(spec: Any) -> Contents:
    """Return the content of a run before its first generation.

    Raise `ValueError` for the spec of a run without an archive.
    """
    if not isinstance(spec, Search):
        raise ValueError(
            f"a spec with an archive is needed, as searches have; got {spec.experiment!r}"
        )
    archive = spec.archive
    ends = ("name", "low", "high", "scale")
    axes = [{name: getattr(one, name) for name in ends} for one in archive.descriptors]
    for axis, one in zip(axes, archive.descriptors, strict=True):
        axis["bins"] = 1 if archive.centroids else one.bins
    if archive.container is not None:
        kind, cells = "pool", archive.places
    elif archive.centroids:
        kind, cells = "cvt", archive.centroids
    else:
        kind, cells = "grid", prod(axis["bins"] for axis in axes)
    return Contents(kind, cells, axes, recorded(spec, (*RECORDED, *archive.named)))


def recorded(spec: Any, names: Sequence[str]) -> list[dict[str, Any]]:
    """Return title, unit and axis of measures of a search."""
    plugins, task = spec.archive.plugins, spec.task
    plugins |= {task.fitness: task.plugin} if task.plugin else {}
    axes = {one.name: one for one in spec.archive.descriptors}
    return [asdict(described(name, plugins, axes)) for name in names]


def of_file(source: bytes | str | Any) -> Contents:
    """Return the content of an archive file. Raise `ValueError` for a file without one."""
    tree, attributes = file.load(source_bytes(source))
    spec = parse(json.loads(attributes["spec"]))
    contents = empty(spec)
    archive, measures = tree["archive"], measured.columns(tree, attributes)
    names = list(measures)
    contents.recorded = recorded(spec, names)
    cells = tessellation(archive, json.loads(attributes["spec"])["archive"])
    contents.centroids = None if cells is None else np.asarray(cells, float).tolist()
    axes = [names.index(axis["name"]) for axis in contents.axes]
    columns = (archive[name].tolist() for name in ("cell", "fitness", "generation"))
    for row, creature, cell, fitness, generation in zip(
        archive["measures"].astype(float), archive["creature"], *columns, strict=True
    ):
        values = fitness, tuple(row[axes].tolist()), generation, bytes(creature).hex()
        contents.elites[cell] = Shown(*values, dict(zip(names, row.tolist(), strict=True)))
    contents.generation = len(tree["curves"]["best"]) if "curves" in tree else 0
    if "poses" in archive:
        streams = poses.streams(tree, attributes)
        contents.streams = {one.creature: one.encode() for one in streams}
    return contents
