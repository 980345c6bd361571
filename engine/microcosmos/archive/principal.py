"""Principal components of measures: axes that are learned from creatures."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..invalid import InvalidField
from .axes import BINS, Axis, floors
from .components import Components, learn, scaled
from .population import Creatures

NAME = re.compile(r"pc([1-9])")
"""Names of components as axes, `pc1` for the first."""
DECIMALS = 3
"""Decimals of the ends of a component's axis."""


@dataclass(frozen=True)
class Component:
    """A principal component of standardised measures."""

    name: str
    explained: float
    """Share of the variance of all measures."""
    loadings: dict[str, float]
    """Weight of each measure times the standard deviation along the component, the strongest
    first: its correlation with the component, but for values that are cut."""
    ends: tuple[float, float]
    """Ends of its axis; a hundredth of the creatures lies beyond each."""


def principal(
    found: Creatures, numbers: Sequence[int], over: Sequence[str] | None = None
) -> tuple[list[Component], Creatures]:
    """Return principal components by number from 1, and the creatures with them as measures.

    `over` names the measures; by default all that are finite for every creature. A creature
    without a finite value of one that is named has no components. Measures that do not vary are
    left out. Raises `ValueError` for too few measures or creatures.
    """
    complete = [name for name, column in found.measures.items() if np.isfinite(column).all()]
    names = sorted(complete if over is None else over)
    columns = [np.asarray(found.measures[name], float) for name in names]
    values = scaled(np.reshape(columns, (len(names), len(found))).T, floors(names))
    able = np.all(np.isfinite(values), axis=1)
    learned = learn(values[able], max(numbers)) if able.any() else None
    vary = np.flatnonzero(learned.scale > 0) if learned else np.zeros(0, int)
    needed = max(2, *numbers)
    if learned is None or len(vary) < needed or np.count_nonzero(able) <= needed:
        raise InvalidField(
            "axes",
            f"of principal components need at least {needed} measures that vary and "
            f"{needed + 1} creatures, got {len(vary)} and {np.count_nonzero(able)}",
        )
    coordinates = np.full((len(found), max(numbers)), np.nan)
    coordinates[able] = learned.coordinates(values[able])
    deviations = coordinates[able].std(0)
    made = [_component(learned, n, names, vary, deviations[n - 1]) for n in numbers]
    added = {f"pc{n}": coordinates[:, n - 1].astype(np.float32) for n in numbers}
    return made, replace(found, measures={**found.measures, **added})


def _component(
    learned: Components,
    number: int,
    names: list[str],
    vary: np.ndarray,
    deviation: float,
) -> Component:
    place = number - 1
    weights = {names[i]: float(learned.weights[place, i] * deviation) for i in vary}
    strongest = dict(sorted(weights.items(), key=lambda item: -abs(item[1])))
    low, high = np.round([learned.low[place], learned.high[place]], DECIMALS).tolist()
    return Component(f"pc{number}", float(learned.explained[place]), strongest, (low, high))


def axis(component: Component, bins: int | None = None) -> Axis:
    """Return the axis of a component."""
    low, high = component.ends
    return Axis(component.name, low, max(high, low + 10**-DECIMALS), bins or BINS)
