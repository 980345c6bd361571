"""An archive as a table: CSV, pandas' data frame, pyribs' archive."""

import csv as csv_module
import json
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from io import StringIO
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..naming import LICENCE
from ..optional import require
from . import measured
from .file import Tree, dump, load
from .poses import PoseStream, streams

Columns = dict[str, Any]
Terms = dict[str, Any]
"""The `licence` of a file, and the names to `credit`."""
IDENTIFIER = r"[\w.:+-]+(?: WITH [\w.:+-]+)?"
JOINED = re.compile(rf"(?:{IDENTIFIER}|\([^()]*\))(?: AND (?:{IDENTIFIER}|\([^()]*\)))*")
"""SPDX licences joined by AND; whole texts, which may have capitals too, are none."""


def csv(data: bytes) -> str:
    """Return the table of `columns` as CSV, one row per elite."""
    return as_csv(columns(data))


def as_csv(found: Columns) -> str:
    """Return columns of equal length as CSV."""
    text = StringIO()
    writer = csv_module.writer(text, lineterminator="\n")
    writer.writerow(found)
    writer.writerows(zip(*(list(column) for column in found.values()), strict=True))
    return text.getvalue()


def columns(data: bytes) -> Columns:
    """Return the table, one entry per elite in each column.

    The columns are `solution_i`, `objective`, `measures_i`, `threshold`, all measures by name,
    `generation`, `creature`, results of reevaluation if there are any, and `index`. A solution
    is the genome's arrays side by side, in the order of their names. In a grid, `measures_i`
    are on the axis' own scale, so that bins of a log axis are equally wide. With centroids,
    they are from 0 to 1 on that scale, on which distances are measured. The index of an archive
    with a container is a place, whose number does not tell where an elite lies.
    """
    tree, attributes = load(data)
    archive = tree["archive"]
    genomes = archive["genomes"]
    arrays = [genomes[name].astype(np.float32) for name in sorted(genomes)]
    rows = [x.reshape(len(x), prod(x.shape[1:])) for x in arrays]  # There may be no row.
    solution = np.concatenate(rows, axis=1)
    spec = json.loads(attributes["spec"])["archive"]
    measures = measured.columns(tree, attributes)
    place = scaled if tessellation(archive, spec) is None else unit
    places = [place(measures[axis["name"]], axis) for axis in spec["descriptors"]]
    fitness = archive["fitness"]
    found: Columns = {f"solution_{i}": solution[:, i] for i in range(solution.shape[1])}
    found |= {"objective": fitness}
    found |= {f"measures_{i}": values for i, values in enumerate(places)}
    found |= {"threshold": fitness}
    found |= measures
    found |= {"generation": archive["generation"]}
    found |= {"creature": [bytes(row).hex() for row in archive["creature"]]}
    return found | repeated(archive) | {"index": archive["cell"]}


def licensed(data: bytes, licence: str, credit: Sequence[str]) -> bytes:
    """Return the same file with a licence and the names to credit."""
    tree, attributes = load(data)
    terms = {"licence": licence, "credit": json.dumps(list(credit))}
    return dump(tree, {**attributes, **terms})


def terms(attributes: Mapping[str, str]) -> Terms:
    """Return the `licence` and `credit` in the attributes of a file; empty without any."""
    if "licence" not in attributes:
        return {}
    credit = json.loads(attributes.get("credit", "[]"))
    return {"licence": attributes["licence"], "credit": credit}


def joint_terms(files: Iterable[Mapping[str, Any]]) -> Terms:
    """Return the terms of what descends from creatures: all licences and all names to credit.

    They are empty if no file has other terms than a new one.
    """
    found = [(one.get("licence", LICENCE), one.get("credit", ())) for one in files]
    given = [(licence, credit) for licence, credit in found if credit or licence != LICENCE]
    if not given:
        return {}
    licences = {licence for licence, _ in given}
    if len(licences) > 1:
        licences = {part for one in licences for part in _parts(one)}
    credit = list(dict.fromkeys(name for _, names in given for name in names))
    return {"licence": " AND ".join(sorted(licences)), "credit": credit}


def _parts(licence: str) -> list[str]:
    """Return the parts of a licence that joins some; any other is one part."""
    if JOINED.fullmatch(licence):
        return re.split(r" AND (?![^(]*\))", licence)
    return [f"({licence})" if " OR " in licence else licence]  # AND binds first.


def centroids(data: bytes) -> np.ndarray:
    """Return the centroids (cell, axis) of a CVT, from 0 to 1 on the axes' own scales."""
    tree, _ = load(data)
    return tree["archive"]["centroids"]


def tessellation(archive: Tree, spec: dict[str, Any]) -> np.ndarray | None:
    """Return the centroids around which cells lie, if they do; containers have no cells."""
    return None if spec.get("container") else archive.get("centroids")


def repeated(archive: Tree) -> Columns:
    """Return the results of reevaluation: count, failures, mean and standard deviation of
    fitness, and the share that fell into the elite's own cell."""
    repeats = archive.get("repeats", {})
    if not np.any(repeats.get("count", 0)):
        return {}
    count, valid = repeats["count"], repeats["count"] - repeats["failed"]
    spread = np.sqrt(repeats["squares"] / np.maximum(valid - 1, 1))
    return {
        "repeats": count,
        "repeats_failed": repeats["failed"],
        "repeats_mean": np.where(valid > 0, repeats["fitness"], np.nan),
        "repeats_std": np.where(valid > 1, spread, np.nan),
        "repeats_hit_rate": np.where(count > 0, repeats["hits"] / np.maximum(count, 1), np.nan),
    }


def scaled(values: np.ndarray, axis: dict[str, Any]) -> np.ndarray:
    """Return values on an axis' own scale, cut at its ends."""
    values = np.clip(values, np.float32(axis["low"]), np.float32(axis["high"]))
    return np.log10(values) if axis["scale"] == "log10" else values


def unit(values: np.ndarray, axis: dict[str, Any]) -> np.ndarray:
    """Return values from 0 to 1 on an axis' own scale."""
    low, high = ends(axis)
    return ((scaled(values, axis) - low) / (high - low)).astype(values.dtype)


def ends(axis: dict[str, Any]) -> tuple[float, float]:
    """Return the ends of an axis on its own scale."""
    low, high = axis["low"], axis["high"]
    if axis["scale"] == "log10":
        return float(np.log10(low)), float(np.log10(high))
    return low, high


Source = bytes | str | os.PathLike
"""An archive file, or its path."""


def pose_streams(archive: Source) -> list[PoseStream]:
    """Return the pose streams of the elites, in the order of their cells.

    Raises `ValueError` for a file of a run without an archive.
    """
    return streams(*load(source_bytes(archive)))


def to_pandas(archive: Source) -> Any:
    """Return a pandas `DataFrame` with pyribs' columns and types; see `export.columns`.

    `ribs.archives.ArchiveDataFrame` takes it as it is. Raises `ImportError` without pandas.
    """
    return require("pandas", "pandas").DataFrame(columns(source_bytes(archive)))


def to_ribs(archive: Source) -> Any:
    """Return pyribs' `GridArchive` or `CVTArchive` with our elites, measures as fields.

    A grid has ranges on the axes' own scales; with centroids they are 0 to 1 on those scales.
    pyribs rounds differently at the borders of bins, so an elite on a border moves to the
    middle of its cell. An archive with a container becomes the grid over its axes, with the
    best elite of each bin. The dot of a plug-in's measure becomes two underscores, since fields
    of pyribs have names of Python. Raises `ImportError` without pyribs.
    """
    data = source_bytes(archive)
    found, peer = columns(data), require("ribs.archives", "ribs[visualize]")
    solution, measures = _stacked(found, "solution_"), _stacked(found, "measures_")
    fields = list(found)[list(found).index("threshold") + 1 : -1]
    fields = {name.replace(".", "__"): np.asarray(found[name]) for name in fields}
    filled = _empty(peer, data, solution.shape[1], fields)
    if not _spec(data).get("container"):
        misplaced = filled.index_of(measures) != found["index"]
        measures[misplaced] = _middles(filled, found["index"])[misplaced]
    filled.add(solution, found["objective"], measures, **fields)
    return filled


def _empty(peer: Any, data: bytes, genes: int, fields: dict[str, np.ndarray]) -> Any:
    spec = _spec(data)
    given = {
        "solution_dim": genes,
        "dtype": np.float32,
        "extra_fields": {
            name: ((), object if values.dtype.kind in "US" else values.dtype)
            for name, values in fields.items()
        },
    }
    axes, centroids = spec["descriptors"], tessellation(load(data)[0]["archive"], spec)
    if centroids is not None:
        return peer.CVTArchive(centroids=centroids, ranges=[(0.0, 1.0)] * len(axes), **given)
    bins, ranges = [axis["bins"] for axis in axes], [ends(axis) for axis in axes]
    return peer.GridArchive(dims=bins, ranges=ranges, **given)


def _spec(data: bytes) -> dict[str, Any]:
    _, attributes = load(data)
    return json.loads(attributes["spec"])["archive"]


def _middles(filled: Any, index: np.ndarray) -> np.ndarray:
    if hasattr(filled, "centroids"):
        return filled.centroids[index]
    place = np.stack(np.unravel_index(index, filled.dims), 1) + 0.5
    return filled.lower_bounds + place / filled.dims * filled.interval_size


def _stacked(found: dict[str, Any], prefix: str) -> np.ndarray:
    return np.stack([x for name, x in found.items() if name.startswith(prefix)], 1)


def source_bytes(archive: Source) -> bytes:
    """Return the file's bytes."""
    return archive if isinstance(archive, bytes) else Path(archive).read_bytes()
