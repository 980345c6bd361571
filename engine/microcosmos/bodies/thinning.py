"""Thinning of bodies for drawings."""

import numpy as np

from .graph import Body


def thinned(body: Body, most: int) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and edges of about `most` nodes: ends, branches, and some in between."""
    every = -(-len(body.positions) // most)
    if every == 1:
        return body.positions, body.edges
    kept = np.bincount(body.edges.ravel(), minlength=len(body.positions)) != 2
    kept[::every] = True
    number = np.cumsum(kept) - 1
    edges = [(number[a], number[b]) for a, b in _spans(body.edges, kept)]
    return body.positions[kept], np.array(edges, int).reshape(-1, 2)


def _spans(edges: np.ndarray, kept: np.ndarray) -> list[tuple[int, int]]:
    """Return the pairs of kept nodes that become neighbours, each path once."""
    met: list[list[int]] = [[] for _ in kept]
    for number, ends in enumerate(edges.tolist()):
        for node in ends:
            met[node].append(number)
    walked, spans = set(), []
    for start in np.flatnonzero(kept).tolist():
        for number in met[start]:
            if number not in walked:
                spans.append((start, _follow(start, number, edges, met, kept, walked)))
    return spans


def _follow(node: int, edge: int, edges, met, kept, walked: set[int]) -> int:
    """Return the first kept node along a path of edges, which are marked as walked."""
    while True:
        walked.add(edge)
        node = int(edges[edge].sum()) - node
        if kept[node]:
            return node
        edge = sum(met[node]) - edge
