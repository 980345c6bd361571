"""Axes of figures: an archive's descriptors, or any other measure."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...archive.export import unit as place_on
from ...spec import Descriptor
from ...spec.measures import MEASURES
from .reading import Archive, Described, plugins_of

BINS = 24
"""Bins of an axis that is not a grid's, as on the page."""


@dataclass(frozen=True)
class Axis:
    """One measure with its ends; places run from 0 to 1 on its own scale."""

    name: str
    label: str
    low: float
    high: float
    logarithmic: bool
    bins: int

    def places(self, values: np.ndarray) -> np.ndarray:
        """Return places of values, cut at the ends."""
        scale = "log10" if self.logarithmic else "linear"
        own = {"low": self.low, "high": self.high, "scale": scale}
        return np.clip(place_on(np.asarray(values, np.float64), own), 0, 1)

    def values(self, places: np.ndarray) -> np.ndarray:
        """Return values of places; the inverse of `places`."""
        low, high = self.low, self.high
        if self.logarithmic:
            return 10 ** (np.log10(low) + places * (np.log10(high) - np.log10(low)))
        return low + places * (high - low)

    @property
    def edges(self) -> np.ndarray:
        return self.values(np.linspace(0, 1, self.bins + 1))


def label(archive: Described, name: str) -> str:
    """Return the title and unit of a measure; a plug-in declares its own."""
    known = plugins_of(archive.spec).get(name) or MEASURES.get(name)
    if known is None:
        return name.replace("_", " ").capitalize()
    return known.title + (f" [{known.unit}]" if known.unit else "")


def fitness_label(archive: Described) -> str:
    task = archive.spec.task
    if task.fitness == "displacement+energy":
        return f"Displacement + {task.energy_weight:g} × energy [cells]"
    return label(archive, task.fitness)


def chosen(archive: Archive, names: list[str] | None) -> list[Axis]:
    """Return the named axes; by default the archive's first two, or its only one."""
    own = {axis.name: axis for axis in archive.axes}
    names = names or list(own)[:2]
    if not 1 <= len(names) <= 2 or len(set(names)) < len(names):
        raise ValueError(f"`axes` must be one or two that differ, got {', '.join(names)}.")
    for name in names:
        if name not in archive.measures:
            raise ValueError(
                f"`axes` must be of {', '.join(own)} (the archive's own) or what else was "
                f"measured ({', '.join(n for n in archive.measures if n not in own)}); "
                f"got {name!r}."
            )
    return [_axis(archive, name, own.get(name)) for name in names]


def _axis(archive: Archive, name: str, own: Descriptor | None) -> Axis:
    """Return the axis of a measure; without one of the archive's `own`, round its ends."""
    title = label(archive, name)
    if own is not None:
        bins = own.bins if archive.centroids is None else BINS
        return Axis(name, title, own.low, own.high, own.scale == "log10", bins)
    known, values = MEASURES.get(name), archive.measures[name].astype(float)
    if known is not None and known.scale == "log10":
        found = np.log10(np.clip(values, known.low, None))
        low, high = np.floor(found.min() + 1e-9), np.ceil(found.max() - 1e-9)
        return Axis(name, title, 10.0**low, 10.0 ** max(high, low + 1), True, BINS)
    least = max(np.ptp(values), 1e-9 * abs(values.max()), 1e-12) / 8
    power = 10.0 ** np.floor(np.log10(least))
    step = next(m * power for m in (1, 2, 5, 10) if m * power >= least * (1 - 1e-9))
    low = step * np.floor(values.min() / step + 1e-9)
    high = max(step * np.ceil(values.max() / step - 1e-9), low + step)
    return Axis(name, title, float(low), float(high), False, BINS)


def label_axes(panel: Any, axes: list[Axis]) -> None:
    """Set ends, scale and label of each axis of a panel."""
    from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

    for axis, which in zip(axes, "xy", strict=False):
        panel.set(**{f"{which}scale": "log" if axis.logarithmic else "linear"})
        panel.set(**{f"{which}lim": (axis.low, axis.high), f"{which}label": axis.label})
        ruler = getattr(panel, f"{which}axis")
        if axis.logarithmic:
            ruler.set_major_locator(LogLocator(10, numticks=9))
            ruler.set_minor_locator(LogLocator(10, subs=tuple(range(2, 10)), numticks=50))
            ruler.set_minor_formatter(NullFormatter())
        else:
            ruler.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
