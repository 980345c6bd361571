"""Principal components of measures, with the same bits on every processor."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import exact

CLIP = 3.0
"""Standard deviations beyond which a measure counts as this far from its mean."""
TAIL = 0.01
"""Share of the rows beyond each end of an axis."""
CONSTANT = 1e-6
"""Relative deviation up to which a measure counts as constant."""
NARROWEST = 1e-3
"""Least length of an axis; a shorter one becomes 1 long."""


@dataclass(frozen=True)
class Components:
    """Axes along which values on their own scales vary most, the first one most of all.

    A coordinate is Σ over measures of weight × deviation from the mean / standard deviation;
    deviations end at ±`CLIP`.
    """

    mean: np.ndarray
    """A number for each measure, as in `scale`; `weights` are (axis, measure)."""
    scale: np.ndarray
    """Standard deviations; 0 where a measure does not count."""
    weights: np.ndarray
    """A unit vector for each axis, its weight of the largest size positive."""
    explained: np.ndarray
    """Share of the variance of all measures along each axis."""
    low: np.ndarray
    """Lower end of each axis; all but a hundredth of the rows are above it."""
    high: np.ndarray

    def coordinates(self, values: np.ndarray) -> np.ndarray:
        """Return coordinates (row, axis) of values (row, measure).

        What is not a number counts as the mean.
        """
        return projected(standardised(values, self.mean, self.scale), self.weights)


def scaled(measures: np.ndarray, least: Sequence[float]) -> np.ndarray:
    """Return measures on their own scales: natural logarithms where `least` is above 0."""
    values = np.array(measures, float)
    for column, floor in enumerate(least):
        if floor:
            clipped = np.maximum(values[:, column], floor)
            finite = np.isfinite(clipped)
            values[finite, column] = exact.logarithm(clipped[finite])
    return values


def learn(values: np.ndarray, axes: int) -> Components:
    """Return the principal components of rows.

    Sums follow the order of the rows, so that must not depend on how they arrived.
    Measures that are constant, or not finite in any row, do not count.
    """
    count, finite = len(values), np.all(np.isfinite(values), 0)
    values = np.ascontiguousarray(np.where(finite[None], values, 0.0), float)
    mean = _mean(values)
    scale = np.sqrt(_mean((values - mean[None]) ** 2))
    constant = scale <= CONSTANT * np.max(np.abs(values), axis=0)
    scale = np.where(finite & ~constant, scale, 0.0)
    rows = standardised(values, mean, scale)
    centred = np.ascontiguousarray(rows - _mean(rows)[None])
    products = (centred[:, i, None] * centred for i in range(centred.shape[1]))
    spread = np.stack([np.add.reduce(one, axis=0) / count for one in products])
    variance, vectors = exact.eigenvectors(spread)
    weights = np.where(scale[None] > 0, vectors[:axes], 0.0)
    largest = np.argmax(np.abs(weights), axis=1)
    flipped = weights[np.arange(len(weights)), largest] < 0
    weights = np.where(flipped[:, None], -weights, weights)
    total = max(float(np.add.accumulate(np.diagonal(spread))[-1]), 1e-30)
    explained = np.maximum(variance[:axes], 0.0) / total
    return Components(mean, scale, weights, explained, *ends(projected(rows, weights)))


def standardised(values: np.ndarray, mean: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Return deviations from the mean in standard deviations, within ±`CLIP`; 0 for what is not
    a number or does not count."""
    counts = (scale > 0)[None] & ~np.isnan(values)
    found = (np.where(counts, values, 0.0) - mean[None]) / np.where(scale > 0, scale, 1.0)[None]
    return np.where(counts, np.clip(found, -CLIP, CLIP), 0.0)


def projected(rows: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the products of rows and weights, summed in the order of measures."""
    total = np.zeros((len(rows), len(weights)))
    for column in range(rows.shape[1]):
        total = total + rows[:, column, None] * weights[None, :, column]
    return total


def ends(coordinates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of axes, beyond each of which a hundredth of the rows lies."""
    ascending, beyond = np.sort(coordinates, axis=0), int(TAIL * (len(coordinates) - 1))
    low, high = ascending[beyond], ascending[len(ascending) - 1 - beyond]
    narrow, middle = high - low < NARROWEST, (low + high) / 2
    return np.where(narrow, middle - 0.5, low), np.where(narrow, middle + 0.5, high)


def _mean(values: np.ndarray) -> np.ndarray:
    """Return means over rows, added in their order."""
    return np.add.reduce(values, axis=0) / len(values)
