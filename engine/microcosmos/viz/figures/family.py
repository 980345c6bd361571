"""Who descends from whom in an archive file."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .reading import Archive

NOBODY = -1


@dataclass(frozen=True, eq=False)
class Family:
    """Entries of the archive as numbers, and their parents'."""

    parents: np.ndarray
    """(entry, 2): entries, −1 for nobody; an only parent is the first."""
    generation: np.ndarray
    fitness: np.ndarray
    cell: np.ndarray
    tips: np.ndarray
    """The entries of the elites that are there now, in the order of the archive's rows."""

    def ancestors(self, entry: int) -> list[int]:
        """An entry and all that it descends from, the youngest first."""
        return self.closure([entry], both=True)

    def closure(self, entries: Iterable[int], *, both: bool) -> list[int]:
        """Entries with all their ancestors, first parents or both; youngest first."""
        found, left = set(), list(entries)
        while left:
            entry = left.pop()
            if entry == NOBODY or entry in found:
                continue
            found.add(entry)
            left.extend(self.parents[entry][: 1 + both].tolist())
        return sorted(found, reverse=True)


def family(found: Archive) -> Family:
    """The family of an archive's elites.

    Raises `ValueError` where an elite is not among those that came into the archive.
    """
    columns = found.lineage
    names = [bytes(row) for row in columns["creature"]]
    number: dict[bytes, int] = {}
    for entry, name in enumerate(names):
        number.setdefault(name, entry)
    parents = [[number.get(bytes(p), NOBODY) for p in row] for row in columns["parents"]]
    latest = dict(zip(columns["cell"].tolist(), range(len(names)), strict=True))
    lost = [int(cell) for cell in found.cells if int(cell) not in latest]
    if lost:
        raise ValueError(
            f"`lineage` must hold every elite; that of cell {lost[0]} is not there"
        )
    return Family(
        parents=np.array([_first(row) for row in parents], int).reshape(-1, 2),
        generation=columns["generation"],
        fitness=columns["fitness"].astype(float),
        cell=columns["cell"],
        tips=np.array([latest[int(cell)] for cell in found.cells]),
    )


def _first(parents: list[int]) -> list[int]:
    """Whoever is there first."""
    return parents if parents[0] != NOBODY else parents[::-1]


def heights(found: Family, entries: list[int]) -> dict[int, float]:
    """Of each entry its place across the tree: childless ones evenly, others between the
    children whose first parent they are. `entries` are closed under first parents.
    """
    children: dict[int, list[int]] = {NOBODY: []}
    for entry in sorted(entries):
        children.setdefault(int(found.parents[entry, 0]), []).append(entry)
    places: dict[int, float] = {}
    ends = 0
    left = [(root, False) for root in reversed(children[NOBODY])]
    while left:
        entry, seen = left.pop()
        own = children.get(entry, [])
        if not own:
            places[entry], ends = float(ends), ends + 1
        elif seen:
            places[entry] = (places[own[0]] + places[own[-1]]) / 2
        else:
            left.append((entry, True))
            left.extend((child, False) for child in reversed(own))
    return places
