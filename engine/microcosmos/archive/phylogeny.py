"""Phylogenies: creatures with parents and times, as ALife standard CSV, Newick and columns."""

import csv
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from math import isinf
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

NONE = -1
"""In columns of integers: no run or operator, an unknown generation, an elite not lost."""


class Birth(NamedTuple):
    """A creature as a run recorded it."""

    creature: str
    parents: Sequence[str]
    run: str | None
    """The run in which it entered an archive first, if any."""
    generation: int
    """Generation of that run, or `NONE`."""
    lost: Mapping[str, int]
    """By run, the generation in which its last cell there went to another; empty while it has
    a cell in any."""
    operator: str | None
    fitness: float | None


Entry = tuple[str, str | None, int | None, int | None, str | None, float | None]
"""Creature, run, generation, the generation in which its cell went to another (None if it
still has it), operator and fitness."""


def entries(
    run: str, rows: Sequence[Sequence[Any]], held: Callable[[str], int | None] | None = None
) -> list[Entry]:
    """Return the entries of a run by generation, from rows of cell, generation, creature,
    fitness and operator, in the order of cells and generations.

    A row without a creature empties its cell. `held` tells of the last creature of a cell when
    it was lost, None if it still has it.
    """
    found: list[Entry] = []
    next_cell, next_generation = None, 0
    for cell, generation, creature, fitness, operator in reversed(rows):
        lost = held(creature) if held and creature else None
        lost = next_generation if cell == next_cell else lost
        if creature is not None:
            found.append((creature, run, generation, lost, operator, fitness))
        next_cell, next_generation = cell, generation
    return sorted(found, key=itemgetter(2))


def births_of(found: Iterable[Entry], links: Mapping[str, Sequence[str]]) -> Iterator[Birth]:
    """Yield the first entry of each creature; it is lost when no run has it in a cell.

    `links` are parents by the name of their child, in the order in which it names them.
    """
    listed: dict[str, list[Entry]] = {}
    for entry in found:
        listed.setdefault(entry[0], []).append(entry)
    for name, mine in listed.items():
        _, run, generation, _, operator, fitness = mine[0]
        ends = [(one[3], one[1]) for one in mine if one[1] and one[3] is not None]
        # Sorted: the last loss of each run counts.
        lost = {name: end for end, name in sorted(ends)} if len(ends) == len(mine) else {}
        yield Birth(
            creature=name,
            parents=links.get(name, ()),
            run=run,
            generation=NONE if generation is None else generation,
            lost=lost,
            operator=operator,
            fitness=fitness,
        )


@dataclass(frozen=True, eq=False)
class Phylogeny:
    """Creatures in the order of their times, so that parents precede their children."""

    creature: list[str]
    runs: list[str]
    operators: list[str]
    links: np.ndarray
    """(link, 2) rows of a child and of a parent; links of a child are in the parents' order."""
    run: np.ndarray
    generation: np.ndarray
    lost: np.ndarray
    """(creature,) the generation of its run at the time of its last loss, in whatever run."""
    operator: np.ndarray
    time: np.ndarray
    """(creature,) generations since the first ancestor, over all runs."""
    fitness: np.ndarray
    """(creature,) NaN where it is unknown."""

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns as arrays for `microcosmos.archive.columns`."""
        names = np.frombuffer(bytes.fromhex("".join(self.creature)), np.uint8)
        numbers = ("run", "generation", "lost", "operator", "time")
        return {
            "creature": names.reshape(-1, 32),
            "links": self.links.astype(np.int32),
            **{name: getattr(self, name).astype(np.int32) for name in numbers},
            "fitness": self.fitness,
        }

    @property
    def destruction(self) -> np.ndarray:
        """(creature,) the time at which a creature lost its last cell, or `NONE`."""
        return np.where(self.lost == NONE, NONE, self.time + self.lost - self.generation)


def phylogeny(
    births: Iterable[Birth], runs: Sequence[str], initial: Iterable[tuple[str, str]] = ()
) -> Phylogeny:
    """Arrange births; `runs` are in the order of their creation, and `initial` are runs with
    creatures from which they start.

    A run begins when all of these and its ancestors in earlier runs exist. Parents that are not
    among the births are left out, and so are links of a creature to its own descendants.
    """
    listed, number = list(births), {name: i for i, name in enumerate(runs)}
    links = _links(listed)
    run = np.array([number.get(one.run or "", NONE) for one in listed], int)
    generation = np.array([one.generation for one in listed], int)
    row = {one.creature: i for i, one in enumerate(listed)}
    starts = [(number[to], row[one]) for to, one in initial if to in number and one in row]
    above = np.array([*zip(run[links[:, 0]], links[:, 1], strict=True), *starts], int)
    begun = _begin(run, generation, above.reshape(-1, 2), len(runs))
    early = np.where(run == NONE, 0, begun[run]) + np.maximum(generation, 0)
    time, links = _times(early, links)
    order = sorted(range(len(listed)), key=lambda i: (time[i], listed[i].creature))
    place = np.empty(len(order), int)
    place[order] = np.arange(len(order))
    moved = place[links]
    since = time - generation
    lost = [
        # A run in which every creature was known before has no place on the axis of time.
        max(
            (
                end if name == one.run else begun[number[name]] + end - since[i]
                for name, end in one.lost.items()
                if name in number
            ),
            default=NONE,
        )
        for i, one in enumerate(listed)
    ]
    names = sorted({one.operator for one in listed if one.operator is not None})
    code = {name: i for i, name in enumerate(names)}
    chosen = [listed[i] for i in order]
    return Phylogeny(
        creature=[one.creature for one in chosen],
        runs=list(runs),
        operators=names,
        links=moved[np.argsort(moved[:, 0], kind="stable")],
        run=run[order],
        generation=generation[order],
        lost=np.array(lost, int)[order],
        operator=np.array([code.get(one.operator or "", NONE) for one in chosen], int),
        time=time[order],
        fitness=np.array([one.fitness for one in chosen], float),
    )


def _links(births: Sequence[Birth]) -> np.ndarray:
    """Return (link, 2) rows of children and parents; a parent named twice has one link."""
    row = {one.creature: i for i, one in enumerate(births)}
    found = [
        (child, row[parent])
        for child, one in enumerate(births)
        for parent in dict.fromkeys(one.parents)
        if parent in row and row[parent] != child
    ]
    return np.array(found, int).reshape(-1, 2)


def _begin(run: np.ndarray, generation: np.ndarray, above: np.ndarray, runs: int) -> np.ndarray:
    """Return the time at which each run begins; `above` are runs, and rows of ancestors."""
    begun = np.zeros(max(runs, 1), int)
    below, ancestor = above.T
    across = (run[ancestor] < below) & (below != NONE)
    for number in np.unique(below[across]):
        above = ancestor[across & (below == number)]
        since = np.where(run[above] == NONE, 0, begun[run[above]])
        begun[number] = (since + np.maximum(generation[above], 0)).max()
    return begun


def _times(early: np.ndarray, links: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return times after those of all parents, none before `early`, and links without cycles.

    Creatures are visited after their parents (Kahn 1962); those that remain lie on cycles or
    descend from one.
    """
    time, waits = early.tolist(), np.bincount(links[:, 0], minlength=len(early)).tolist()
    children: list[list[int]] = [[] for _ in time]
    for child, parent in links.tolist():
        children[parent].append(child)
    ready = [i for i, count in enumerate(waits) if count == 0]
    for parent in ready:  # It grows.
        for child in children[parent]:
            time[child] = max(time[child], time[parent] + 1)
            waits[child] -= 1
            if waits[child] == 0:
                ready.append(child)
    closed = np.array(waits, int) > 0
    on_cycle = closed[links[:, 0]] & closed[links[:, 1]] if len(links) else np.zeros(0, bool)
    return np.array(time, int), links[~on_cycle]


def alife_csv(found: Phylogeny) -> str:
    """Return the ALife phylogeny standard's table: `id`, `ancestor_list`, `origin_time`,
    `destruction_time`, and further columns of ours.

    An id is a row. The `destruction_time` of an elite is `inf`, as phylotrackpy has it, and
    that of a creature that entered no archive its origin.
    """
    ancestors: list[list[int]] = [[] for _ in found.creature]
    for child, parent in found.links.tolist():
        ancestors[child].append(parent)
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    head = ("id", "ancestor_list", "origin_time", "destruction_time", "taxon_label")
    writer.writerow((*head, "run", "generation", "operator", "fitness"))
    fitness = found.fitness.tolist()
    lives = np.where(np.asarray(found.run) == NONE, found.time, np.inf)
    ended = np.where(found.destruction == NONE, lives, found.destruction).tolist()
    for i, name in enumerate(found.creature):
        listed = ",".join(map(str, ancestors[i])) or "none"
        run, operator, generation = found.run[i], found.operator[i], found.generation[i]
        writer.writerow(
            (
                *(
                    i,
                    f"[{listed}]",
                    found.time[i],
                    "inf" if isinf(ended[i]) else int(ended[i]),
                    name,
                ),
                "" if run == NONE else found.runs[run],
                "" if generation == NONE else generation,
                "" if operator == NONE else found.operators[operator],
                fitness[i] if fitness[i] == fitness[i] else "",
            )
        )
    return text.getvalue()


def newick(found: Phylogeny) -> str:
    """Return a tree in Newick's format for each first ancestor, one a line.

    A child belongs to its first parent; lengths are generations.
    """
    parent = np.full(len(found.creature), NONE)
    child, above = found.links[::-1].T  # The first link of a child is written last.
    parent[child] = above
    children: list[list[int]] = [[] for _ in found.creature]
    for one, first in enumerate(parent.tolist()):
        if first != NONE:
            children[first].append(one)
    length = found.time - np.where(parent == NONE, 0, found.time[parent])
    label = [f"{name}:{span}" for name, span in zip(found.creature, length, strict=True)]
    roots = np.flatnonzero(parent == NONE).tolist()
    return "".join(_tree(root, children, label) for root in roots)


def _tree(root: int, children: Sequence[Sequence[int]], label: Sequence[str]) -> str:
    parts: list[str] = []
    left: list[int | str] = [";\n", root]
    while left:
        one = left.pop()
        if isinstance(one, str):
            parts.append(one)
        elif below := children[one]:
            parts.append("(")
            left.append(f"){label[one]}")
            for place, child in enumerate(reversed(below)):
                left += [",", child] if place else [child]
        else:
            parts.append(label[one])
    return "".join(parts)
