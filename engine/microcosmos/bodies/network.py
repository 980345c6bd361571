"""Bodies from nodes and edges, as lists or as a networkx graph."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .graph import Body
from .shape import from_edges


def graph(
    nodes: Sequence[Any] | np.ndarray,
    edges: Sequence[Any] | np.ndarray,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Body:
    """Any filaments, at rest as they are drawn: places and pairs of node numbers."""
    return from_edges(
        np.array(nodes, float).reshape(-1, 2),
        np.array(edges, int).reshape(-1, 2),
        stretch=stretch,
        shear=shear,
        bend=bend,
    )


def from_graph(
    graph: Any, *, stretch: float = 1.0, shear: float = 1.0, bend: float = 1.0
) -> Body:
    """The body of a networkx graph whose nodes have a place, `pos`, in cells.

    Edges may have a `rest_length`, `stretch` or `shear` of their own.
    """
    places = dict(graph.nodes(data="pos"))
    for name, place in places.items():
        if place is None or np.shape(place) != (2,):
            raise ValueError(f"`pos` of node {name!r} must be two numbers, got {place!r}.")
    number = {name: i for i, name in enumerate(places)}
    ends = np.array([(number[a], number[b]) for a, b in graph.edges()], int).reshape(-1, 2)
    positions = np.array(list(places.values()), float)
    own = [data for _, _, data in graph.edges(data=True)]
    return from_edges(
        positions,
        ends,
        rest_length=_each(own, "rest_length", np.nan),
        stretch=_each(own, "stretch", stretch),
        shear=_each(own, "shear", shear),
        bend=bend,
    )


def _each(own: list[dict[str, Any]], name: str, default: float) -> np.ndarray:
    return np.array([data.get(name, default) for data in own], float)
