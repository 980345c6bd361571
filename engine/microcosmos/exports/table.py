"""Tables: named columns with titles and units, before they become Arrow or xarray."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..archive.export import ends


class Ragged(NamedTuple):
    """A list in each row: all items one after another, and the number in each row."""

    items: Any
    """An array or a list of texts, or lists themselves, as another `Ragged`."""
    counts: np.ndarray


class Column(NamedTuple):
    """Values of all rows, with their meaning.

    An array of two axes has a list of one length in each row.
    """

    values: np.ndarray | Sequence[str | None] | Ragged
    title: str
    unit: str = "1"
    repeated: bool = False
    """Whether few different texts repeat, so that a dictionary holds them."""
    axis: Mapping[str, Any] | None = None
    """Ends, bins and scale, if it is an axis of the archive."""


Columns = dict[str, Column]


@dataclass(frozen=True)
class Elites:
    """The elites of an archive: how cells lie, and columns with an entry for each elite."""

    kind: str
    """`grid`, `cvt` or `pool`, as `client.Archive.kind`."""
    axes: Sequence[Mapping[str, Any]]
    cell: np.ndarray
    columns: Columns
    centroids: np.ndarray | None = None
    """(cell, axis) of a CVT, from 0 to 1 on the axes' own scales, where they are known."""
    attributes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, ...]:
        """Return the bins along each axis of a grid."""
        return tuple(axis["bins"] for axis in self.axes)


def values_at(places: np.ndarray, axis: Mapping[str, Any]) -> np.ndarray:
    """Return raw values at places from 0 to 1 on an axis' own scale."""
    low, high = ends(dict(axis))
    found = low + np.asarray(places, float) * (high - low)
    return 10**found if axis["scale"] == "log10" else found


def placed(name: str, taken: Mapping[str, Any]) -> str:
    """Return a name that no other column has."""
    return name if name not in taken else placed(f"measure_{name}", taken)
