"""Archives for other libraries: a pandas data frame, and an archive of pyribs."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from ..optional import require
from .export import columns, ends
from .file import load

Source = bytes | str | os.PathLike
"""An archive file, or its path."""


def to_pandas(archive: Source) -> Any:
    """Return a pandas `DataFrame` with pyribs' columns and types; see `export.columns`.

    `ribs.archives.ArchiveDataFrame` takes it as it is. Raises `ImportError` without pandas.
    """
    return require("pandas", "pandas").DataFrame(columns(_bytes(archive)))


def to_ribs(archive: Source) -> Any:
    """Return pyribs' `GridArchive` or `CVTArchive` with our elites, measures as fields.

    A grid has ranges on the axes' own scales; with centroids they are 0 to 1 on those scales.
    pyribs rounds differently at the borders of bins, so an elite on a border moves to the
    middle of its cell. Raises `ImportError` without pyribs.
    """
    data = _bytes(archive)
    found, peer = columns(data), require("ribs.archives", "ribs[visualize]")
    solution, measures = _beside(found, "solution_"), _beside(found, "measures_")
    fields = list(found)[list(found).index("threshold") + 1 : -1]
    fields = {name: np.asarray(found[name]) for name in fields}
    filled = _empty(peer, data, solution.shape[1], fields)
    misplaced = filled.index_of(measures) != found["index"]
    measures[misplaced] = _middles(filled, found["index"])[misplaced]
    filled.add(solution, found["objective"], measures, **fields)
    return filled


def _empty(peer: Any, data: bytes, genes: int, fields: dict[str, np.ndarray]) -> Any:
    tree, attributes = load(data)
    spec = json.loads(attributes["spec"])["archive"]
    given = {
        "solution_dim": genes,
        "dtype": np.float32,
        "extra_fields": {
            name: ((), object if values.dtype.kind in "US" else values.dtype)
            for name, values in fields.items()
        },
    }
    axes, centroids = spec["descriptors"], tree["archive"].get("centroids")
    if centroids is not None:
        return peer.CVTArchive(centroids=centroids, ranges=[(0.0, 1.0)] * len(axes), **given)
    bins, ranges = [axis["bins"] for axis in axes], [ends(axis) for axis in axes]
    return peer.GridArchive(dims=bins, ranges=ranges, **given)


def _middles(filled: Any, index: np.ndarray) -> np.ndarray:
    if hasattr(filled, "centroids"):
        return filled.centroids[index]
    place = np.stack(np.unravel_index(index, filled.dims), 1) + 0.5
    return filled.lower_bounds + place / filled.dims * filled.interval_size


def _beside(found: dict[str, Any], prefix: str) -> np.ndarray:
    return np.stack([x for name, x in found.items() if name.startswith(prefix)], 1)


def _bytes(archive: Source) -> bytes:
    return archive if isinstance(archive, bytes) else Path(archive).read_bytes()
