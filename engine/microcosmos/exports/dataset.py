"""An archive as an xarray dataset, and its netCDF file."""

import json
from io import BytesIO
from typing import Any

import numpy as np

from ..archive.export import Source, source_bytes
from ..optional import require
from ..quantities.real import Real
from .arrow import EXTRA
from .run_file import RunFile
from .si import elites_with_si
from .tables import Column, Elites, Ragged, elites, values_at

FORMAT = "microcosmos-dataset/1"


def to_xarray(archive: Source, *, length: str | None = None, period: str | None = None) -> Any:
    """Return the elites of an archive file as an `xarray.Dataset`.

    A grid has a dimension for each descriptor, whose coordinates are the middles of bins, with
    their ends in `NAME_bounds`. Empty cells are NaN, and their creature is "". Other archives
    have one dimension, `cell` or `place`, with descriptors as coordinates along it: those of
    the centroids, or of the elites. The elites' own values of a descriptor are
    `elite_NAME`. With the real `length` of a body, such as `1mm`, and `period` of a stroke,
    such as `0.5s`, variables `NAME_si` have the elites' values in SI units. Raises `ValueError`
    for a run without an archive, and for a length or period without a known unit, and
    `ImportError` without xarray.
    """
    return of_run(RunFile("run", source_bytes(archive)), Real.of(length, period))


def of_run(run: RunFile, real: Real | None = None) -> Any:
    """Return the elites of a run as a dataset, with SI units if real quantities are given."""
    selected = elites(run)
    return of_elites(selected if real is None else elites_with_si(selected, run, real))


def of_elites(found: Elites) -> Any:
    """Return elites as a dataset."""
    xarray = require("xarray", EXTRA)
    if found.kind == "grid":
        coordinates, dimensions, shape = _grid(found)
    else:
        coordinates, dimensions, shape = _along(found)
    taken = {*coordinates, *dimensions, "cell"}
    # Places of a container have gaps, and their numbers no meaning.
    row = np.arange(len(found.cell)) if found.kind == "pool" else found.cell
    variables = {}
    for name, column in found.columns.items():
        # The coordinates of the dataset say both.
        if name == "cell" or name.startswith("bin_"):
            continue
        named = f"elite_{name}" if name in taken else name
        variables[named] = (dimensions, _spread(column, row, shape), _about(column))
    return xarray.Dataset(variables, coordinates, _attributes(found))


def _grid(found: Elites) -> tuple[dict[str, Any], list[str], tuple[int, ...]]:
    coordinates: dict[str, Any] = {}
    for axis in found.axes:
        name, bins = axis["name"], axis["bins"]
        edges = values_at(np.arange(bins + 1) / bins, axis)
        about = _about(found.columns[name]) | {
            "scale": axis["scale"],
            "bounds": f"{name}_bounds",
        }
        middles = values_at((np.arange(bins) + 0.5) / bins, axis)
        coordinates[name] = (name, middles, about)
        coordinates[f"{name}_bounds"] = ((name, "side"), np.stack([edges[:-1], edges[1:]], 1))
    return coordinates, [axis["name"] for axis in found.axes], found.shape


def _along(found: Elites) -> tuple[dict[str, Any], list[str], tuple[int, ...]]:
    """Return coordinates along the cells of a CVT, or along the elites of a container."""
    coordinates: dict[str, Any] = {}
    centroids = found.centroids
    dimension = "cell" if found.kind == "cvt" else "place"
    numbers = found.cell if centroids is None else np.arange(len(centroids), dtype=np.int32)
    coordinates[dimension] = numbers
    for i, axis in enumerate(found.axes):
        column = found.columns[axis["name"]]
        values = column.values if centroids is None else values_at(centroids[:, i], axis)
        about = _about(column) | {"scale": axis["scale"]}
        coordinates[axis["name"]] = (dimension, values, about)
    return coordinates, [dimension], (len(numbers),)


def _spread(column: Column, row: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return the values of elites in their cells, NaN or "" in the others."""
    values, cells = column.values, int(np.prod(shape))
    assert not isinstance(values, Ragged)
    if not isinstance(values, np.ndarray):
        whole = np.full(cells, "", object)
    elif values.dtype == np.float32:
        whole = np.full(cells, np.nan, np.float32)
    else:
        whole = np.full(cells, np.nan)  # Double precision holds every int32.
    whole[row] = values
    return whole.reshape(shape)


def _about(column: Column) -> dict[str, str]:
    """Return attributes with which xarray labels plots."""
    named = {"units": column.unit} if column.unit not in ("", "1") else {}
    return {"long_name": column.title, **named}


def _attributes(found: Elites) -> dict[str, Any]:
    """Return attributes that netCDF can hold: texts and numbers."""
    whole = {"format": FORMAT, "source": "Microcosmos", "kind": found.kind, **found.attributes}
    plain = (str, int, float)
    return {
        name: value if isinstance(value, plain) else json.dumps(value, ensure_ascii=False)
        for name, value in whole.items()
    }


def netcdf(dataset: Any) -> bytes:
    """Return a netCDF 4 file, written by h5netcdf."""
    # It writes into memory, where the netCDF4 library needs a file.
    require("h5netcdf", EXTRA)
    file = BytesIO()
    packed = {
        name: {"zlib": True, "complevel": 4}
        for name, variable in dataset.data_vars.items()
        if variable.dtype.kind == "f"
    }
    dataset.to_netcdf(file, engine="h5netcdf", encoding=packed)
    return file.getvalue()
