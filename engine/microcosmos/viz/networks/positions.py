"""Positions of a creature's network as plain data, for programs that draw it themselves."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise, product
from typing import Any

from .graph import Pairs
from .layout import COLUMN, ROW, layout


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

    Nodes of a layered network are numbered like those of NEAT: inputs, outputs, hidden nodes.
    Raises `ValueError` if the genes are no network.
    """
    genome = identity["genome"]
    if "nodes" in genome:
        keys, links = genome["nodes"]["id"], genome["connections"]
        pairs = list(zip(links["source"], links["target"], strict=True))
    elif genome["encoding"] == "weights":
        keys, pairs = _layered(genome)
    else:
        raise ValueError(f"`genome.encoding` must hold a network, got {genome['encoding']!r}")
    first, fixed = len(genome["inputs"]), len(genome["inputs"]) + len(genome["outputs"])
    found = layout(keys, first, keys[first:fixed], pairs)
    points = [*found.place.values(), *(point for way in found.ways.values() for point in way)]
    columns, rows = zip(*points, strict=True)

    def scaled(point: tuple[float, float]) -> Point:
        return Point(point[0] / COLUMN, round((point[1] - min(rows)) / ROW, 3))

    passing = {f"{a}-{b}": way[1:-1] for (a, b), way in found.ways.items() if way[2:]}
    end = scaled((max(columns), max(rows)))
    return NetworkPositions(
        width=end.x,
        height=end.y,
        nodes={str(key): scaled(point) for key, point in found.place.items()},
        passages={ends: [scaled(point) for point in way] for ends, way in passing.items()},
    )


def _layered(genome: Mapping[str, Any]) -> tuple[Sequence[int], Pairs]:
    inputs, outputs = len(genome["inputs"]), len(genome["outputs"])
    starts = list(accumulate(genome["control"]["hidden"], initial=inputs + outputs))
    hidden = [range(*ends) for ends in pairwise(starts)]
    layers = [range(inputs), *hidden, range(inputs, inputs + outputs)]
    return range(starts[-1]), [pair for ends in pairwise(layers) for pair in product(*ends)]
