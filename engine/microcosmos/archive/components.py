"""Principal components of measures: axes that are learned from creatures."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..spec.measures import MEASURES
from .axes import BINS, Axis
from .population import Creatures

NAME = re.compile(r"pc([1-9])")
"""Names of components as axes, `pc1` for the first."""
ENDS = 1.0, 99.0
"""Percentiles at the ends of a component's axis."""
DECIMALS = 3
"""Decimals of these ends."""

LOGARITHMIC = {name: one.low for name, one in MEASURES.items() if one.scale == "log10"}
"""Measures that are taken as logarithms, with the least value of each."""


@dataclass(frozen=True)
class Component:
    """A principal component of standardised measures."""

    name: str
    explained: float
    """Share of the variance of all measures."""
    loadings: dict[str, float]
    """Correlation of each measure with the component, the strongest first."""


def principal(
    found: Creatures, numbers: Sequence[int], over: Sequence[str] | None = None
) -> tuple[list[Component], Creatures]:
    """Return principal components by number from 1, and the creatures with them as measures.

    `over` names the measures; by default all that are finite for every creature. A creature
    without a finite value of one that is named has no components. Measures that do not vary are
    left out. Raises `ValueError` for too few measures or creatures.
    """
    table, names, able = _standardised(found, over)
    needed = max(2, *numbers)
    if len(names) < needed or len(table) <= needed:
        raise ValueError(
            f"`axes` of principal components need at least {needed} measures that vary and "
            f"{needed + 1} creatures, got {len(names)} and {len(table)}"
        )
    variances, vectors = np.linalg.eigh(table.T @ table / len(table))
    made, columns = [], dict(found.measures)
    for number in numbers:
        variance, weights = max(float(variances[-number]), 0.0), _signed(vectors[:, -number])
        columns[f"pc{number}"] = np.full(len(found), np.nan, np.float32)
        columns[f"pc{number}"][able] = table @ weights
        loadings = zip(names, (weights * np.sqrt(variance)).tolist(), strict=True)
        strongest = dict(sorted(loadings, key=lambda item: -abs(item[1])))
        made.append(Component(f"pc{number}", variance / len(names), strongest))
    return made, replace(found, measures=columns)


def axis(name: str, found: Creatures, bins: int | None = None) -> Axis:
    """Return the axis of a component, which ends at the percentiles `ENDS`."""
    scores = found.measures[name].astype(float)
    low, high = np.round(np.nanpercentile(scores, ENDS), DECIMALS).tolist()
    return Axis(name, low, high if high > low else low + 10**-DECIMALS, bins or BINS)


def _signed(weights: np.ndarray) -> np.ndarray:
    """Return the vector whose largest entry, the first of nearly equal ones, is positive."""
    sizes = np.abs(weights)
    return weights * np.sign(weights[np.argmax(sizes > 0.999 * sizes.max())])


def _standardised(
    found: Creatures, over: Sequence[str] | None
) -> tuple[np.ndarray, list[str], np.ndarray]:
    """Return a table (creature, measure), the measures, and which creatures it has."""
    complete = [name for name, column in found.measures.items() if np.isfinite(column).all()]
    names = sorted(complete if over is None else over)
    columns = np.array([_scaled(name, found.measures[name]) for name in names])
    able = np.all(np.isfinite(columns.reshape(len(names), len(found))), axis=0)
    if not names or not able.any():
        return np.empty((0, 0)), [], able
    columns = columns[:, able]
    columns -= columns.mean(1)[:, None]
    spread = columns.std(1)
    varies = spread > 1e-6 * np.maximum(1e-30, np.abs(columns).max(1))
    table = (columns[varies] / spread[varies, None]).T
    return table, [name for name, one in zip(names, varies, strict=True) if one], able


def _scaled(name: str, column: np.ndarray) -> np.ndarray:
    column = column.astype(float)
    return np.log10(np.maximum(column, LOGARITHMIC[name])) if name in LOGARITHMIC else column
