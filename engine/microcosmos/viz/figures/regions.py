"""Regions of an archive's map, each with the fittest elite that stands in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .axes import Axis, chosen
from .maps import fittest
from .reading import Archive


@dataclass(frozen=True)
class Region:
    """A part of the sheet: which elite is shown at (column, row) from the low ends."""

    column: int
    row: int
    elite: int


@dataclass(frozen=True)
class Layout:
    """The regions of a sheet that have somebody, and what of each axis it shows."""

    axes: tuple[Axis, Axis]
    ends: np.ndarray
    """(axis, 2): places from 0 to 1 between which the sheet lies."""
    columns: int
    rows: int
    regions: tuple[Region, ...]


@dataclass(frozen=True, eq=False)
class Motion:
    """A body over its life."""

    positions: np.ndarray
    """(frame, node, 2), unwrapped, in cells."""
    edges: np.ndarray
    """(edge, 2) node numbers."""


def layout(
    found: Archive, *, axes: list[str] | None = None, columns: int = 6, rows: int = 4
) -> Layout:
    """Regions of equal size over what of two axes has elites; the fittest stands for each.

    Raises `ValueError` where there is one axis alone.
    """
    along = chosen(found, axes)
    if len(along) != 2:
        raise ValueError(
            "`axes` must be two for a sheet, such as --axes bending_effort,path_length"
        )
    for name, value in (("columns", columns), ("rows", rows)):
        if not 1 <= value <= 20:
            raise ValueError(f"`{name}` must be from 1 to 20, got {value}.")
    places = np.stack([axis.places(found.measures[axis.name]) for axis in along])
    ends = np.stack([_ends(axis, own) for axis, own in zip(along, places, strict=True)])
    share = (places - ends[:, :1]) / np.diff(ends)
    counts = np.array([[columns], [rows]])
    there = np.clip((share * counts).astype(int), 0, counts - 1)
    regions = tuple(Region(*map(int, (*there[:, i], i))) for i in fittest(found, there))
    return Layout((along[0], along[1]), ends, columns, rows, regions)


def _ends(axis: Axis, places: np.ndarray) -> np.ndarray:
    """Between which places there are elites, rounded outwards to the axis' bins."""
    low = np.floor(places.min() * axis.bins + 1e-9)
    high = np.ceil(places.max() * axis.bins - 1e-9)
    return np.array([low, max(high, low + 1)]) / axis.bins


def numerals(count: int) -> list[str]:
    """i, ii, iii, iv ... as the paper numbers its gaits."""
    digits = (("c", 100), ("xc", 90), ("l", 50), ("xl", 40), ("x", 10), ("ix", 9), ("v", 5),
              ("iv", 4), ("i", 1))  # fmt: skip
    found = []
    for number in range(1, count + 1):
        text = ""
        for letters, value in digits:
            text, number = text + letters * (number // value), number % value
        found.append(text)
    return found


def reading_order(regions: Sequence[Region]) -> list[int]:
    """The numbers of regions row by row from the top."""
    return sorted(range(len(regions)), key=lambda k: (-regions[k].row, regions[k].column))
