"""The tree of an archive: descent of its elites, and the ancestors of one of them."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .reading import Archive, fitness_label
from .style import GREY, INK, blank, colour_bar, shades

NO_ENTRY = -1


@dataclass(frozen=True, eq=False)
class Family:
    """Entries of an archive and their parents, by number."""

    parents: np.ndarray
    """(entry, 2) entries, −1 for none; an only parent is the first."""
    generation: np.ndarray
    fitness: np.ndarray
    cell: np.ndarray
    tips: np.ndarray
    """The entries of the present elites, in the order of the archive's rows."""

    def ancestors(self, entries: Iterable[int], *, both: bool = True) -> list[int]:
        """Return entries and their ancestors, by both parents or the first; youngest first."""
        found, left = set(), list(entries)
        while left:
            entry = left.pop()
            if entry == NO_ENTRY or entry in found:
                continue
            found.add(entry)
            left.extend(self.parents[entry][: 1 + both].tolist())
        return sorted(found, reverse=True)


def family(archive: Archive) -> Family:
    """Return the family of an archive's elites. Raises `ValueError` if one is lacking."""
    columns = archive.lineage
    names = [bytes(row) for row in columns["creature"]]
    number: dict[bytes, int] = {}
    for entry, name in enumerate(names):
        number.setdefault(name, entry)
    parents = [[number.get(bytes(p), NO_ENTRY) for p in row] for row in columns["parents"]]
    parents = [row if row[0] != NO_ENTRY else row[::-1] for row in parents]
    latest = dict(zip(columns["cell"].tolist(), range(len(names)), strict=True))
    lost = [int(cell) for cell in archive.cells if int(cell) not in latest]
    if lost:
        raise ValueError(
            f"`lineage` must hold every elite; the elite of cell {lost[0]} is missing"
        )
    return Family(
        parents=np.array(parents, int).reshape(-1, 2),
        generation=columns["generation"],
        fitness=columns["fitness"].astype(float),
        cell=columns["cell"],
        tips=np.array([latest[int(cell)] for cell in archive.cells]),
    )


def heights(tree: Family, entries: list[int]) -> dict[int, float]:
    """Return the height of each entry: childless ones evenly, others between their children.

    A child belongs to its first parent. `entries` include all first parents.
    """
    children: dict[int, list[int]] = {NO_ENTRY: []}
    for entry in sorted(entries):
        children.setdefault(int(tree.parents[entry, 0]), []).append(entry)
    places, ends = {}, 0
    left = [(root, False) for root in reversed(children[NO_ENTRY])]
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


OTHERS = "#a9b4b9"
"""Colour of other elites."""


def lineage(
    archive: Archive,
    *,
    cell: int | None = None,
    colours: str = "viridis",
    width: float = 178.0,
) -> Any:
    """Draw generations from left to right; all elites and their first parents are grey.

    Ancestors of the elite of `cell` (none: the fittest) have the colours of their fitness;
    dashed lines lead from second parents.
    """
    from matplotlib.collections import LineCollection

    tree = family(archive)
    own = int(tree.tips[archive.row(cell)])
    above = tree.ancestors([own])
    whole = tree.ancestors([*tree.tips.tolist(), *above], both=False)
    places = heights(tree, whole)
    ends = sum(1 for place in set(places.values()) if place == int(place))
    figure = blank(width, float(np.clip(0.9 * ends, 55, 0.62 * width)))
    panel = figure.add_subplot()
    values = tree.fitness[above]
    colouring = shades(values, colours)
    _branches(panel, tree, places, whole, colors=[OTHERS], linewidths=0.4, zorder=1)
    last = max(int(tree.generation.max()), len(archive.curves["best"]))
    tips = tree.tips.tolist()
    alive = [[(tree.generation[tip], places[tip]), (last, places[tip])] for tip in tips]
    dots = {"colors": [OTHERS], "linewidths": 0.3, "linestyles": [(0, (1, 2))]}
    panel.add_collection(LineCollection(alive, zorder=0, **dots))
    colour = colouring.to_rgba(values)
    _branches(panel, tree, places, above, colors=[INK], linewidths=2.0, zorder=2)
    _branches(panel, tree, places, above, colors=colour, linewidths=1.3, zorder=3)
    _crossings(panel, tree, places, above)
    x, y = tree.generation[above], [places[entry] for entry in above]
    panel.scatter(x, y, s=9, c=colour, edgecolors=INK, linewidths=0.4, zorder=4)
    panel.scatter([x[0]], [y[0]], s=34, facecolors="none", edgecolors=INK, lw=0.8, zorder=5)
    _dress(panel, last)
    colour_bar(panel, colouring, fitness_label(archive), pad=0.01, aspect=28)
    return figure


def _branches(
    panel: Any, tree: Family, places: dict[int, float], entries: list[int], **look: Any
) -> None:
    from matplotlib.collections import LineCollection

    lines = []
    for entry in entries:
        parent, x, y = int(tree.parents[entry, 0]), tree.generation[entry], places[entry]
        if parent == NO_ENTRY:
            # A root has no branch, but keeps its place: colours are given by entry.
            start = (x, y)
            lines.append([start, start, start])
        else:
            from_x = tree.generation[parent]
            lines.append([(from_x, places[parent]), (from_x, y), (x, y)])
    panel.add_collection(LineCollection(lines, capstyle="round", joinstyle="round", **look))


def _crossings(panel: Any, tree: Family, places: dict[int, float], entries: list[int]) -> None:
    for entry in entries:
        other = int(tree.parents[entry, 1])
        if other != NO_ENTRY:
            x = [tree.generation[other], tree.generation[entry]]
            y = [places[other], places[entry]]
            panel.plot(x, y, color=GREY, lw=0.5, ls=(0, (3, 2)), zorder=1.5)


def _dress(panel: Any, last: int) -> None:
    from matplotlib.ticker import MaxNLocator

    panel.set(xlabel="Generation", yticks=[], xlim=(0, last + max(1, 0.01 * last)))
    panel.margins(y=0.02)
    panel.autoscale_view(scalex=False)
    panel.xaxis.set_major_locator(MaxNLocator(8, integer=True))
    panel.spines[["top", "right", "left"]].set_visible(False)
