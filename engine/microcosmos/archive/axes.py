"""Axes of archives: the bins of a measure."""

from dataclasses import dataclass

import numpy as np

from .. import exact
from ..spec.measures import Measure, Scale
from ..spec.search import Descriptor

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


def axis(
    name: str, usual: Descriptor | Measure | None, values: np.ndarray, bins: int | None = None
) -> Axis:
    """Return the axis of a measure, with the ends and the scale of `usual`.

    An archive's own descriptor gives its bins too. Without `usual`, the axis ends at the lowest
    and the highest of the values.
    """
    bins = bins or (usual.bins if isinstance(usual, Descriptor) else BINS)
    if usual is not None:
        return Axis(name, usual.low, usual.high, bins, usual.scale)
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    return Axis(name, low, high if high > low else low + 1, bins)
