"""Re-projection: the elites among evaluated creatures over any other axes.

A creature that lost its cell to a fitter one can be the best of a cell of other axes. A
re-projection inserts all creatures anew, in the total order of archives: fitness, then the
smaller name. Creatures in any order give the same result.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import prod

import numpy as np

from ..invalid import InvalidField
from ..measures import MEASURES
from ..spec.search import MAX_CELLS
from . import principal
from .axes import Axis, axis, cells
from .population import Creatures
from .principal import NAME, Component

FITNESS = "fitness"
COMPONENTS = "pc1", "pc2"
"""Axes that learn the two largest principal components."""


@dataclass(frozen=True, eq=False)
class Reprojection:
    """The archive of creatures over some axes."""

    creatures: Creatures
    """Their measures include those of the axes."""
    axes: tuple[Axis, ...]
    entries: np.ndarray
    """Rows of the creatures that took a cell, in the order of generation and cell."""
    cells: np.ndarray
    """Cells of the entries, in C order over the bins of the axes."""

    @cached_property
    def last(self) -> np.ndarray:
        """Index of the last entry of each filled cell, in the order of cells."""
        _, found = np.unique(self.cells[::-1], return_index=True)
        return len(self.cells) - 1 - found

    @property
    def elites(self) -> np.ndarray:
        """Return the row of each filled cell's elite, in the order of cells."""
        return self.entries[self.last]

    @property
    def filled(self) -> np.ndarray:
        """Return the filled cells."""
        return self.cells[self.last]

    @property
    def count(self) -> int:
        """Return the number of cells."""
        return prod(one.bins for one in self.axes)

    @property
    def coverage(self) -> float:
        return len(self.last) / self.count

    @property
    def qd_score(self) -> float:
        """Return the sum of the elites' fitness."""
        return float(self.creatures.fitness[self.elites].sum(dtype=np.float64))

    @property
    def best(self) -> float | None:
        """Return the highest fitness; None without an elite."""
        return float(self.creatures.fitness[self.elites].max()) if len(self.last) else None


def over(
    found: Creatures,
    names: Sequence[str],
    own: Mapping[str, Axis] | None = None,
    bins: Sequence[int] = (),
    components_of: Sequence[str] | None = None,
) -> tuple[Reprojection, list[Component]]:
    """Re-project creatures onto measures, `fitness` or components (`pc1`) by name.

    An axis of the archive's `own` keeps its ends, scale and bins; any other has the ends and
    the scale of the measure. `bins` gives other bins, one number for all or one for each.
    `components_of` names the measures that components are made of. Raises `ValueError` for
    wrong names.
    """
    _refuse(found, names, bins, components_of or ())
    numbers = [int(one[1]) for one in map(NAME.fullmatch, names) if one]
    learned: list[Component] = []
    if numbers:
        learned, found = principal.principal(found, numbers, components_of)
    found = replace(found, measures={**found.measures, FITNESS: found.fitness})
    usual = {**MEASURES, **(own or {})}
    sizes = [*bins] * len(names) if len(bins) == 1 else bins or [None] * len(names)
    made = {one.name: one for one in learned}
    axes = [
        principal.axis(made[name], size)
        if name in made
        else axis(name, usual.get(name), found.measures[name], size)
        for name, size in zip(names, sizes, strict=True)
    ]
    return reproject(found, axes), learned


def reproject(found: Creatures, axes: Sequence[Axis]) -> Reprojection:
    """Insert creatures into cells over axes, whose names are among their measures.

    Creatures whose fitness or measures are not finite never enter. Raises `ValueError` for too
    many cells.
    """
    if (count := prod(one.bins for one in axes)) > MAX_CELLS:
        raise InvalidField("bins", f"must give at most {MAX_CELLS:,} cells, got {count:,}")
    values = [found.measures[one.name] for one in axes]
    able = np.flatnonzero(np.all(np.isfinite([found.fitness, *values]), axis=0))
    cell = cells(axes, [column[able] for column in values])
    generation = found.generation[able]
    rank = np.empty(len(able), np.int64)
    rank[np.argsort(-found.fitness[able], kind="stable")] = np.arange(len(able))
    entered = _leaders(cell, generation, rank)
    order = entered[np.lexsort((cell[entered], generation[entered]))]
    return Reprojection(found, tuple(axes), able[order], cell[order])


def _leaders(cell: np.ndarray, generation: np.ndarray, rank: np.ndarray) -> np.ndarray:
    """Return the rows that rank above all of their cell, in their generation and before."""
    order = np.lexsort((rank, generation, cell))
    # A later cell has lower keys, so that the running minimum starts anew with each cell.
    _, place = np.unique(cell[order], return_inverse=True)
    lowest = np.minimum.accumulate(rank[order] - place * (len(rank) + 1))
    leads = np.ones(len(order), bool)
    leads[1:] = lowest[1:] < lowest[:-1]
    return order[leads]


def _refuse(
    found: Creatures, names: Sequence[str], bins: Sequence[int], of: Sequence[str]
) -> None:
    if not names or len(set(names)) < len(names):
        raise InvalidField(
            "axes", f"must be names that differ, got {', '.join(names) or 'none'}"
        )
    known = ", ".join(found.measures)
    able = {*found.measures, FITNESS, *filter(NAME.fullmatch, names)}
    if wrong := [name for name in names if name not in able]:
        needed = f"fitness, pc1 to pc9 or measures ({known})"
        raise InvalidField("axes", f"must be {needed}; got {', '.join(wrong)}")
    if wrong := [name for name in of if name not in found.measures]:
        raise InvalidField(
            "components_of", f"must be measures ({known}); got {', '.join(wrong)}"
        )
    if len(bins) not in (0, 1, len(names)) or any(not 1 <= one <= 1024 for one in bins):
        got = ", ".join(map(str, bins))
        raise InvalidField(
            "bins", f"must be one number from 1 to 1,024, or one for each axis; got {got}"
        )
