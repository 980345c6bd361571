"""Measures of elites and creatures: their values by name, titles and units."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..measures import MEASURES, Scale

NONE: Mapping[str, Any] = {}


class Titled(Protocol):
    """A plug-in's version: its title and unit."""

    @property
    def title(self) -> str: ...
    @property
    def unit(self) -> str: ...


@dataclass(frozen=True)
class Described:
    """A measure as people read it, and the ends of its axis where they are known."""

    name: str
    title: str
    unit: str
    low: float | None = None
    high: float | None = None
    scale: Scale = "linear"

    @property
    def label(self) -> str:
        """Return the title with the unit."""
        return self.title + (f" [{self.unit}]" if self.unit else "")


def described(
    name: str, plugins: Mapping[str, Titled] = NONE, axes: Mapping[str, Any] = NONE
) -> Described:
    """Return a measure's title, unit and axis.

    `plugins` are the versions of plug-ins by name, `axes` the descriptors of an archive: one of
    a plug-in has the ends that the archive gives it. A name that this version does not know is
    its own title.
    """
    plugin, known = plugins.get(name), MEASURES.get(name)
    if plugin is None and known is not None:
        return Described(name, known.title, known.unit, known.low, known.high, known.scale)
    if plugin is None:
        return Described(name, name.replace("_", " ").capitalize(), "")
    axis = axes.get(name)
    ends = () if axis is None else (axis.low, axis.high, axis.scale)
    return Described(name, plugin.title, plugin.unit, *ends)


def columns(tree: Mapping[str, Any], attributes: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Return a column of each measure of the elites in an archive file."""
    names = json.loads(attributes["measures"])
    return dict(zip(names, tree["archive"]["measures"].T, strict=True))


def of_creature(measured: Mapping[str, Any] | None) -> dict[str, float]:
    """Return the measures in the `measured` of a creature file or of a creature's row.

    They are empty for a creature that was not measured.
    """
    return dict((measured or {}).get("measures", {}))
