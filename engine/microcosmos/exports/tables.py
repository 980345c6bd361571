"""Tables of a run's file, as named columns with titles and units, before they become Arrow."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from typing import Any, NamedTuple

import numpy as np

from ..archive import file
from ..archive.curves import COUNTS, CURVES
from ..archive.export import ends, repeated, tessellation
from ..archive.poses import streams
from .run_file import RunFile, described, fitness_of, hexes


class Ragged(NamedTuple):
    """A list in each row: all items one after another, and the number in each row."""

    items: Any
    """An array or a list of texts, or lists themselves, as another `Ragged`."""
    counts: np.ndarray


class Column(NamedTuple):
    """Values of all rows, with their meaning.

    An array of two axes has a list of one length in each row.
    """

    values: np.ndarray | Sequence[str | None] | Ragged
    title: str
    unit: str = "1"
    repeated: bool = False
    """True for a few texts that repeat, which a dictionary then holds."""
    axis: Mapping[str, Any] | None = None
    """Ends, bins and scale, if it is an axis of the archive."""


Columns = dict[str, Column]


@dataclass(frozen=True)
class Elites:
    """The elites of an archive: how cells lie, and columns with an entry for each elite."""

    kind: str
    """`grid`, `cvt` or `pool`, as `client.Archive.kind`."""
    axes: Sequence[Mapping[str, Any]]
    cell: np.ndarray
    columns: Columns
    centroids: np.ndarray | None = None
    """(cell, axis) of a CVT, from 0 to 1 on the axes' own scales, where they are known."""
    attributes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, ...]:
        """Return the bins along each axis of a grid."""
        return tuple(axis["bins"] for axis in self.axes)


def values_at(places: np.ndarray, axis: Mapping[str, Any]) -> np.ndarray:
    """Return raw values at places from 0 to 1 on an axis' own scale."""
    low, high = ends(dict(axis))
    values = low + np.asarray(places, float) * (high - low)
    return 10**values if axis["scale"] == "log10" else values


def placed(name: str, taken: Mapping[str, Any]) -> str:
    """Return a name that no other column has."""
    return name if name not in taken else placed(f"measure_{name}", taken)


REPEATS = {
    "repeats": ("Evaluations under disturbed conditions", "1"),
    "repeats_failed": ("Infeasible ones among them", "1"),
    "repeats_mean": ("Their mean fitness", "fitness"),
    "repeats_std": ("Standard deviation of their fitness", "fitness"),
    "repeats_hit_rate": ("Share in the elite's own cell", "1"),
}


def elites(run: RunFile) -> Elites:
    """Return the elites of a run's archive; raise `ValueError` for a run without one."""
    archive, spec = run.archive(), run.spec
    around = tessellation(archive, spec["archive"])
    pool = spec["archive"].get("container") is not None
    axes = {axis["name"]: axis for axis in spec["archive"]["descriptors"]}
    operators, devices = (json.loads(run.attributes[n]) for n in ("operators", "device"))
    unit, entered = fitness_of(spec["task"], run.plugins), archive["generation"]
    columns: Columns = {
        "creature": Column(hexes(archive["creature"]), "SHA-256 of the creature's identity"),
        "cell": Column(archive["cell"], "Place in the container" if pool else "Cell"),
        "fitness": Column(archive["fitness"], "Fitness", unit),
        "generation": Column(entered, "Generation of the elite", "generations"),
        "age": Column((run.generation - entered).astype(np.int32), "Age", "generations"),
        "operator": _word(archive["operator"], operators, "Operator that made it"),
        "device": _word(archive["device"], devices, "Kind of device that measured it"),
        "curiosity": Column(archive["curiosity"], "Score as a parent"),
    }
    if around is None and not pool:
        columns |= bins(archive["cell"], list(axes.values()))
    for name, values in run.measures.items():
        title, of = described(name, run.plugins)
        # A plug-in may name its measure as a column of ours.
        columns[placed(name, columns)] = Column(values, title, of, axis=axes.get(name))
    for name, values in repeated(archive).items():
        columns[name] = Column(values, *REPEATS[name])
    kind = "pool" if pool else "grid" if around is None else "cvt"
    listed = list(axes.values())
    return Elites(kind, listed, archive["cell"], columns, around, run.facts())


def bins(cell: np.ndarray, axes: list[dict[str, Any]]) -> Columns:
    """Return the bin of cells of a grid along each axis."""
    places = np.unravel_index(cell, [axis["bins"] for axis in axes])
    return {
        f"bin_{axis['name']}": Column(
            one.astype(np.int32), f"Bin of {axis['name']}, from 0, in the cell's number"
        )
        for axis, one in zip(axes, places, strict=True)
    }


def archive(run: RunFile) -> Columns:
    """Return a row for each elite, in the order of cells."""
    return elites(run).columns


def genomes(run: RunFile) -> Columns:
    """Return the genes of each elite: a list for each array of the genome."""
    archive = run.archive()
    return {
        "creature": Column(hexes(archive["creature"]), "SHA-256 of the creature's identity"),
        **{
            name: Column(_listed(genes), f"Genes: {name.replace('_', ' ')}")
            for name, genes in sorted(archive["genomes"].items())
        },
    }


def _listed(genes: np.ndarray) -> Ragged:
    """Return genes as lists, since rows of another run may have another length."""
    return Ragged(genes.ravel(), np.full(len(genes), prod(genes.shape[1:])))


def curves(run: RunFile) -> Columns:
    """Return a row for each generation."""
    # `archive` refuses runs without one, whose curves have other columns.
    tree, count = run.tree, len(run.archive() and run.tree["curves"]["qd_score"])
    unit = fitness_of(run.spec["task"], run.plugins)
    numbers = np.arange(1, count + 1, dtype=np.int32)
    columns = {"generation": Column(numbers, "Generation", "generations")}
    for name, values in tree["curves"].items():
        # Files keep all curves as reals; counts are whole in a table.
        whole = values.astype(np.int64) if name in COUNTS else values
        curve = CURVES[name]
        columns[name] = Column(whole, curve.description, unit if curve.of == "fitness" else "1")
    for name, values in tree["emitters"].items():
        for i, column in enumerate(values.T):
            columns[f"emitter_{i}_{name}"] = Column(column, f"Emitter {i}: {name}")
    for group in ("screening", "fronts"):
        for name, values in tree.get(group, {}).items():
            about = f"{group}: {name}".replace("_", " ").capitalize()
            columns[f"{group}_{name}"] = Column(values, about)
    return columns


def lineage(run: RunFile) -> Columns:
    """Return a row for each entry into the archive, in order, with the parents."""
    if "lineage" not in run.tree:
        raise ValueError("a run that fills an archive is needed for a lineage; got a table")
    rows, axes = run.tree["lineage"], run.spec["archive"]["descriptors"]
    present = rows["parents"].any(-1)
    operators = json.loads(run.attributes["operators"])
    unit = fitness_of(run.spec["task"], run.plugins)
    columns: Columns = {
        "creature": Column(hexes(rows["creature"]), "SHA-256 of the creature's identity"),
        "parents": Column(
            Ragged(hexes(rows["parents"][present]), present.sum(1)),
            "Its nearest ancestors that entered the archive too",
        ),
        "operator": _word(rows["operator"], operators, "Operator that made it"),
        "generation": Column(rows["generation"], "Generation in which it entered"),
        "cell": Column(rows["cell"], "Cell or place"),
        "fitness": Column(rows["fitness"], "Fitness", unit),
    }
    for i, axis in enumerate(axes):
        title, of = described(axis["name"], run.plugins)
        values = rows["descriptors"][:, i]
        columns[placed(axis["name"], columns)] = Column(values, title, of, axis=axis)
    return columns


def poses(run: RunFile) -> Columns:
    """Return the last two strokes of each elite: places of nodes at equal times."""
    run.archive()
    return pose_columns(streams(run.tree, run.attributes))


def pose_columns(streams_of_elites: list[Any]) -> Columns:
    """Return pose streams as columns; see `archive.poses.PoseStream`."""
    frames = np.array([len(one.positions) for one in streams_of_elites], int)
    nodes = np.array([one.positions.shape[1] for one in streams_of_elites], int)
    cells = [one.cells for one in streams_of_elites]

    def places(axis: int) -> Ragged:
        flat = [each[..., axis].ravel() for each in cells]
        # NumPy joins no empty list, and an archive may have no elite
        # (test_a_ro_crate_has_a_table_without_rows).
        items = np.concatenate(flat) if flat else np.zeros(0, np.float32)
        return Ragged(Ragged(items, np.repeat(nodes, frames)), frames)

    def joined(parts: list[np.ndarray], kind: str) -> Ragged:
        items = np.concatenate(parts).astype(kind) if parts else np.zeros(0, kind)
        return Ragged(items, np.array([len(part) for part in parts], int))

    edges = joined([np.asarray(one.edges).reshape(-1, 2) for one in streams_of_elites], "i4")
    paired = edges._replace(items=edges.items.reshape(-1, 2))
    return {
        "creature": Column(
            [one.creature for one in streams_of_elites], "SHA-256 of the identity"
        ),
        "nodes": Column(nodes.astype(np.int32), "Nodes of the body"),
        "strokes": _each(
            streams_of_elites, "strokes", np.int32, "Strokes that the frames span"
        ),
        "length": _each(streams_of_elites, "length", np.float32, "Length of the body", "cells"),
        "step": Column(
            joined([one.times for one in streams_of_elites], "i4"), "Steps done", "steps"
        ),
        "x": Column(places(0), "x of each node in each frame, unwrapped", "cells"),
        "y": Column(places(1), "y of each node in each frame, unwrapped", "cells"),
        "edges": Column(paired, "Pairs of nodes that edges connect"),
        "path_x": Column(
            joined([one.path[:, 0] for one in streams_of_elites], "f4"), _PATH, "cells"
        ),
        "path_y": Column(
            joined([one.path[:, 1] for one in streams_of_elites], "f4"), _PATH, "cells"
        ),
    }


_PATH = "Mean position of nodes at equal times of the whole simulation"


def _each(found: list[Any], name: str, kind: Any, title: str, unit: str = "1") -> Column:
    return Column(np.array([getattr(one, name) for one in found], kind), title, unit)


def result(run: RunFile) -> Columns:
    """Return the rows of a run without an archive: a gait sweep, a folding …"""
    rows = json.loads(bytes(run.tree["loop"]["rows"]))
    names = dict.fromkeys(name for row in rows for name in row)
    return {
        name: Column(_values([row.get(name) for row in rows]), name.replace("_", " "), "")
        for name in names
    }


def _values(values: list[Any]) -> Any:
    if all(isinstance(value, bool) for value in values):
        return np.array(values)
    if all(isinstance(value, int | float | None) for value in values):
        return np.array([np.nan if value is None else value for value in values], float)
    return [None if value is None else str(value) for value in values]


def _word(numbers: np.ndarray, words: list[str], title: str) -> Column:
    return Column(file.words(numbers, words), title, repeated=True)


Maker = Callable[[RunFile], Columns]
OF_ARCHIVE: Mapping[str, Maker] = {
    "archive": archive,
    "curves": curves,
    "lineage": lineage,
    "genomes": genomes,
    "poses": poses,
}
"""Tables of a search, by name."""
OF_TABLE: Mapping[str, Maker] = {"result": result}
"""Tables of other runs."""


def makers(run: RunFile) -> Mapping[str, Maker]:
    """Return the functions that make the tables of a run, by name."""
    return OF_ARCHIVE if run.has_archive else OF_TABLE


def names(runs: list[RunFile]) -> Iterator[str]:
    """Yield the names of the tables that any of the runs has."""
    yield from dict.fromkeys(name for run in runs for name in makers(run))
