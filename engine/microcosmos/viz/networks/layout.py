"""Layout of drawn networks: columns by depth, few crossings.

Columns, places held for long connections and ordering by means of neighbours follow
Sugiyama, Tagawa and Toda, IEEE Trans. Syst. Man Cybern. 11, 109 (1981).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from ...networks.network import Pairs, depths

Item = int | tuple[int, int, int]
"""A node's key, or the place in a column that a long connection passes through."""

COLUMN, ROW, PASSAGE = 150.0, 46.0, 20.0
"""Distance of columns, and heights of a node and of a passing connection."""

SWEEPS = 12


@dataclass(frozen=True)
class Layout:
    """Positions of nodes by key, and the points that each connection passes."""

    place: dict[int, tuple[float, float]]
    ways: dict[tuple[int, int], tuple[tuple[float, float], ...]]


def layout(keys: Sequence[int], inputs: int, outputs: Sequence[int], pairs: Pairs) -> Layout:
    """Place inputs left, outputs right, hidden nodes by the longest path to them.

    Inputs are the keys below `inputs`; connections may close cycles.
    """
    column = _columns(keys, inputs, outputs, pairs)
    chains = {pair: _chain(pair, column) for pair in pairs}
    columns: list[list[Item]] = [[] for _ in range(max(column.values()) + 1)]
    for key in keys:
        columns[column[key]].append(key)
    for (source, _), chain in chains.items():
        for level, passage in enumerate(chain[1:-1], column[source] + 1):
            columns[level].append(passage)
    height = _ordered(columns, _neighbours(chains))
    rows = enumerate(columns)
    places = {item: (COLUMN * n, height[item]) for n, items in rows for item in items}
    return Layout(
        {key: places[key] for key in keys},
        {pair: tuple(places[item] for item in chain) for pair, chain in chains.items()},
    )


def _columns(
    keys: Sequence[int], inputs: int, outputs: Sequence[int], pairs: Pairs
) -> dict[int, int]:
    fed = {*range(inputs), *(target for _, target in pairs)}
    bare = [(0, key) for key in keys if key not in fed]  # As if an input led there.
    column = depths(keys, [*pairs, *bare])
    ends = {*range(inputs), *outputs}
    last = max([1, *(column[key] + 1 for key in keys if key not in ends)])
    return column | dict.fromkeys(outputs, last)


def _chain(pair: tuple[int, int], column: dict[int, int]) -> list[Item]:
    source, target = pair
    between = range(column[source] + 1, column[target])
    return [source, *((source, target, level) for level in between), target]


def _neighbours(chains: dict[tuple[int, int], list[Item]]) -> dict[Item, list[Item]]:
    near: dict[Item, list[Item]] = {}
    for chain in chains.values():
        for one, other in pairwise(chain):
            near.setdefault(one, []).append(other)
            near.setdefault(other, []).append(one)
    return near


def _ordered(columns: list[list[Item]], near: dict[Item, list[Item]]) -> dict[Item, float]:
    """Return heights: repeatedly, every item moves towards its neighbours.

    Inputs and outputs keep their order; the others are sorted by their targets.
    """
    height: dict[Item, float] = {}
    for items in columns:
        height |= _apart(items, [0.0] * len(items))
    for sweep in range(SWEEPS):
        forward = sweep % 2 == 0
        # Alternate directions: each item moves towards sources, then towards targets.
        for number in range(len(columns)) if forward else reversed(range(len(columns))):
            items = columns[number]
            around = {item: near.get(item, [item]) for item in items}
            target = {x: sum(height[y] for y in near) / len(near) for x, near in around.items()}
            if 0 < number < len(columns) - 1:
                items.sort(key=lambda item, target=target: target[item])
            height |= _apart(items, [target[item] for item in items])
    return height


def _apart(items: list[Item], targets: list[float]) -> dict[Item, float]:
    """Return heights in this order, far enough apart, nearest to the targets in least squares.

    The offsets taken away, this is isotonic regression by pooling neighbours.
    """
    offset, offsets = 0.0, []
    for place, item in enumerate(items):
        if place:
            offset += (_size(item) + _size(items[place - 1])) / 2
        offsets.append(offset)
    pools: list[tuple[float, int]] = []
    for target, offset in zip(targets, offsets, strict=True):
        total, count = target - offset, 1
        while pools and pools[-1][0] / pools[-1][1] >= total / count:
            total, count = total + pools[-1][0], count + pools[-1][1]
            pools.pop()
        pools.append((total, count))
    levels = [total / count for total, count in pools for _ in range(count)]
    return {i: level + o for i, level, o in zip(items, levels, offsets, strict=True)}


def _size(item: Item) -> float:
    return PASSAGE if isinstance(item, tuple) else ROW


@dataclass(frozen=True)
class Point:
    """A place: x in columns, y in rows."""

    x: float
    y: float


@dataclass(frozen=True)
class NetworkPositions:
    """Points from (0, 0) to (width, height)."""

    width: float
    height: float
    nodes: dict[str, Point]
    """Positions of nodes, by number."""
    passages: dict[str, list[Point]]
    """Points that a connection passes between distant columns, by "source-target"."""


def positions(identity: Mapping[str, Any]) -> NetworkPositions:
    """Place the nodes of a creature's network; disabled connections count.

    Raises `ValueError` if the genes are no network.
    """
    genome = identity["genome"]
    if "nodes" not in genome:
        raise ValueError(f"`genome.encoding` must hold a network, got {genome['encoding']!r}")
    keys, links = genome["nodes"]["id"], genome["connections"]
    pairs = list(zip(links["source"], links["target"], strict=True))
    first, fixed = len(genome["inputs"]), len(genome["inputs"]) + len(genome["outputs"])
    placed = layout(keys, first, keys[first:fixed], pairs)
    points = [*placed.place.values(), *(point for way in placed.ways.values() for point in way)]
    columns, rows = zip(*points, strict=True)

    def scaled(point: tuple[float, float]) -> Point:
        return Point(point[0] / COLUMN, round((point[1] - min(rows)) / ROW, 3))

    passing = {f"{a}-{b}": way[1:-1] for (a, b), way in placed.ways.items() if way[2:]}
    end = scaled((max(columns), max(rows)))
    return NetworkPositions(
        width=end.x,
        height=end.y,
        nodes={str(key): scaled(point) for key, point in placed.place.items()},
        passages={ends: [scaled(point) for point in way] for ends, way in passing.items()},
    )
