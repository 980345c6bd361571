"""Principal components of measures, with the same bits on every processor."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from .. import exact
from ..spec.measures import MEASURES

CLIP = 3.0
"""Standard deviations beyond which a measure counts as this far from its mean."""
TAIL = 0.01
"""Share of the rows beyond each end of an axis."""
CONSTANT = 1e-6
"""Relative deviation up to which a measure counts as constant."""
NARROWEST = 1e-3
"""Least length of an axis; a shorter one becomes 1 long."""

Values = Float[np.ndarray, "row measure"]
Floats = Float[np.ndarray, "_"]


@dataclass(frozen=True)
class Components:
    """Axes along which values on their own scales vary most, the first one most of all.

    A coordinate is Σ over measures of weight × deviation from the mean / standard deviation;
    deviations end at ±`CLIP`.
    """

    mean: Float[np.ndarray, "measure"]
    scale: Float[np.ndarray, "measure"]
    """Standard deviations; 0 where a measure does not count."""
    weights: Float[np.ndarray, "axis measure"]
    """A unit vector for each axis, its weight of the largest size positive."""
    explained: Float[np.ndarray, "axis"]
    """Share of the variance of all measures along each axis."""
    low: Float[np.ndarray, "axis"]
    """Lower end of each axis; all but a hundredth of the rows are above it."""
    high: Float[np.ndarray, "axis"]

    def coordinates(self, values: Values) -> Float[np.ndarray, "row axis"]:
        """Return the coordinates of rows of values; what is not a number counts as the mean."""
        return projected(standardised(values, self.mean, self.scale), self.weights)


def floors(names: Sequence[str]) -> tuple[float, ...]:
    """Return the least value of each measure that enters as a logarithm, 0 for the others.

    It is a hundredth of the lower end of the measure's own axis.
    """
    known = (MEASURES.get(name) for name in names)
    return tuple(one.low / 100 if one and one.scale == "log10" else 0.0 for one in known)


def scaled(measures: Values, least: Sequence[float]) -> Values:
    """Return measures on their own scales: natural logarithms where `least` is above 0."""
    values = np.array(measures, float)
    for column, floor in enumerate(least):
        if floor:
            found = np.maximum(values[:, column], floor)
            there = np.isfinite(found)
            values[there, column] = exact.logarithm(found[there])
    return values


def learn(values: Values, axes: int) -> Components:
    """Return the principal components of rows, which must be in an order of their own.

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


def standardised(values: Values, mean: Floats, scale: Floats) -> Values:
    """Return deviations from the mean in standard deviations, within ±`CLIP`; 0 for what is not
    a number or does not count."""
    counts = (scale > 0)[None] & ~np.isnan(values)
    found = (np.where(counts, values, 0.0) - mean[None]) / np.where(scale > 0, scale, 1.0)[None]
    return np.where(counts, np.clip(found, -CLIP, CLIP), 0.0)


def projected(rows: Values, weights: Float[np.ndarray, "axis measure"]) -> np.ndarray:
    """Return the products of rows and weights, summed in the order of measures."""
    total = np.zeros((len(rows), len(weights)))
    for column in range(rows.shape[1]):
        total = total + rows[:, column, None] * weights[None, :, column]
    return total


def ends(coordinates: Float[np.ndarray, "row axis"]) -> tuple[Floats, Floats]:
    """Return the ends of axes, beyond each of which a hundredth of the rows lies."""
    ascending, beyond = np.sort(coordinates, axis=0), int(TAIL * (len(coordinates) - 1))
    low, high = ascending[beyond], ascending[len(ascending) - 1 - beyond]
    narrow, middle = high - low < NARROWEST, (low + high) / 2
    return np.where(narrow, middle - 0.5, low), np.where(narrow, middle + 0.5, high)


def _mean(values: Values) -> Float[np.ndarray, "measure"]:
    """Return means over rows, added in their order."""
    return np.add.reduce(values, axis=0) / len(values)
