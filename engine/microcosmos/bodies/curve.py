"""Bodies along drawn curves: polylines and SVG paths."""

from collections.abc import Sequence
from typing import Any, Unpack

import numpy as np

from .. import exact
from ..optional import require
from .graph import Body
from .shape import Stiffness, from_edges

SAMPLES = 512
"""Points on each curved piece of an SVG path, on which nodes are then spaced evenly."""


def polyline(
    points: Sequence[Any] | np.ndarray,
    spacing: float,
    closed: bool = False,
    **stiffness: Unpack[Stiffness],
) -> Body:
    """Build a filament along `points`, its nodes at equal arc lengths of about `spacing` cells.

    A closed one ends at the first point, which may be repeated as the last.
    """
    corners = np.array(points, float)
    _refuse_curve(corners, spacing)
    places, edges = _strand(corners, spacing, closed)
    arc = np.arange(len(places)) / len(edges)
    return from_edges(places, edges, arc, **stiffness)


def svg(text: str, spacing: float, **stiffness: Unpack[Stiffness]) -> Body:
    """Build filaments along an SVG path's `d`, or along all shapes of an SVG document.

    A unit is a cell, y turned upwards. A strand that ends less than half of `spacing`
    from a node is joined to it. Needs svgpathtools.
    """
    places, edges, used = [], [], 0
    for corners, closed in _strands(text):
        _refuse_curve(corners, spacing)
        found, pairs = _strand(corners, spacing, closed)
        places.append(found)
        edges.append(pairs + used)
        used += len(found)
    if not places:
        raise ValueError("`text` must hold an SVG path, got none.")
    joined, pairs = _join(np.concatenate(places), np.concatenate(edges), spacing / 2)
    return from_edges(joined, pairs, **stiffness)


def _refuse_curve(corners: np.ndarray, spacing: float) -> None:
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 2:
        raise ValueError(f"`points` must be at least two (x, y), got {corners.shape}.")
    if not np.isfinite(corners).all():
        raise ValueError("`points` must be finite.")
    if not spacing > 0:
        raise ValueError(f"`spacing` must be positive, got {spacing:g}.")


def _strand(corners: np.ndarray, spacing: float, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    if closed:
        corners = np.concatenate([corners, corners[:1]])
    steps = np.diff(corners, axis=0)
    way = np.concatenate([[0], np.cumsum(exact.length(steps[:, 0], steps[:, 1]))])
    if way[-1] == 0:
        raise ValueError("`points` must not all be the same.")
    count = max(round(way[-1] / spacing), 3 if closed else 1)
    at = np.linspace(0, way[-1], count + 1)[: count + (not closed)]
    places = np.stack([np.interp(at, way, x) for x in corners.T], 1)
    number = np.arange(count)
    return places, np.stack([number, (number + 1) % len(places)], 1)


def _strands(text: str) -> list[tuple[np.ndarray, bool]]:
    """Return the points of every unbroken part of the SVG, and whether it is closed."""
    svgpathtools = require("svgpathtools", "microcosmos[shapes]")
    if "<svg" in text:
        paths = svgpathtools.Document.from_svg_string(text).paths()
    else:
        paths = [svgpathtools.parse_path(text)]
    parts = [part for path in paths for part in path.continuous_subpaths()]
    return [(_points(part, svgpathtools.Line), part.isclosed()) for part in parts]


def _points(path, straight: type) -> np.ndarray:
    """Return points along an SVG path, y upwards; only the ends of straight pieces."""
    z = [path[0].start]
    for piece in path:
        count = 1 if isinstance(piece, straight) else SAMPLES
        z.extend(piece.point(t) for t in np.linspace(0, 1, count + 1)[1:])
    return np.stack([np.real(z), -np.imag(z)], 1)


def _join(places: np.ndarray, edges: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Merge ends of strands with nodes nearer than `reach`."""
    same = list(range(len(places)))

    def root(node: int) -> int:
        return node if same[node] == node else root(same[node])

    degree = np.bincount(edges.reshape(-1), minlength=len(places))
    for end in np.flatnonzero(degree == 1).tolist():
        gap = exact.length(*(places - places[end]).T)
        gap[end] = np.inf
        nearest = int(np.argmin(gap))
        if gap[nearest] < reach and root(nearest) != end:
            same[end] = root(nearest)
    merged, number = np.unique([root(node) for node in same], return_inverse=True)
    return places[merged], number[edges]
