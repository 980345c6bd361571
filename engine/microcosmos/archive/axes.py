"""Axes of archives: the bins of a measure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import exact
from ..measures import MEASURES, Measure, Scale

BINS = 24
"""Bins of an axis that is not an archive's own, as on the page."""


@dataclass(frozen=True)
class Axis:
    """One measure with its ends; values beyond an end are in the outer bin."""

    name: str
    low: float
    high: float
    bins: int
    scale: Scale = "linear"

    def bin(self, values: np.ndarray) -> np.ndarray:
        """Return numbers of half-open bins, those of an archive over this axis."""
        edges = exact.edges(self.low, self.high, self.bins, logarithmic=self.scale == "log10")
        return np.searchsorted(edges, np.asarray(values, np.float32), side="right")


def cells(axes: Sequence[Axis], columns: Sequence[np.ndarray]) -> np.ndarray:
    """Return the cells of values, a column for each axis, in C order over the bins."""
    found = np.zeros(len(columns[0]), np.int64)
    for one, column in zip(axes, columns, strict=True):
        found = found * one.bins + one.bin(column)
    return found


def of_spec(spec: Mapping[str, Any]) -> dict[str, Axis]:
    """Return the axes of a run's archive by name, from its spec as JSON."""
    archive = spec["archive"]
    names = ("name", "low", "high", "scale")
    grid = archive.get("centroids") is None
    found = [
        Axis(**{name: one[name] for name in names}, bins=one["bins"] if grid else BINS)
        for one in archive["descriptors"]
    ]
    return {one.name: one for one in found}


def axis(
    name: str, usual: Axis | Measure | None, values: np.ndarray, bins: int | None = None
) -> Axis:
    """Return the axis of a measure, with the ends and the scale of `usual`.

    An archive's own axis gives its bins too. Without `usual`, the axis ends at the lowest and
    the highest of the values.
    """
    bins = bins or (usual.bins if isinstance(usual, Axis) else BINS)
    if usual is not None:
        return Axis(name, usual.low, usual.high, bins, usual.scale)
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    return Axis(name, low, high if high > low else low + 1, bins)


def floors(names: Sequence[str]) -> tuple[float, ...]:
    """Return the least value of each measure that enters as a logarithm, 0 for the others.

    It is a hundredth of the lower end of a built-in measure's own axis. Those of plug-ins enter
    as they are: creatures of several runs may be on other axes.
    """
    known = (MEASURES.get(name) for name in names)
    return tuple(one.low / 100 if one and one.scale == "log10" else 0.0 for one in known)
