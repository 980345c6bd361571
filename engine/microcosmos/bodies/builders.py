"""Builders of bodies: filaments, circles, stars, trees, graphs, and drawn curves."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Unpack

import numpy as np

from .. import exact
from ..invalid import InvalidField
from ..optional import require
from .graph import Body
from .shape import Stiffness, from_edges, rows_of_two

FORK_ANGLE_RATIO = 0.9
"""Ratio of the angles of successive forks: equal forks would overlap."""


def chain(
    nodes: int, spacing: float, *, stretch: float = 1.0, shear: float = 1.0, bend: float = 1.0
) -> Body:
    """Build a straight filament along x, its nodes `spacing` cells apart."""
    _refuse_fewer("nodes", nodes, 2)
    number = np.arange(nodes)
    return Body(
        positions=np.stack([number * spacing, np.zeros(nodes)], 1),
        edges=np.stack([number[:-1], number[1:]], 1),
        joints=np.stack([number[:-2], number[1:-1]], 1),
        rest_length=np.full(nodes - 1, float(spacing)),
        rest_angle=np.zeros(nodes - 2),
        stretch=np.full(nodes - 1, float(stretch)),
        shear=np.full(nodes - 1, float(shear)),
        bend=np.full(nodes - 2, float(bend)),
        arc=number / (nodes - 1),
    )


def walk(
    nodes: int, spacing: float, deviation: float, seed: int, **stiffness: Unpack[Stiffness]
) -> Body:
    """Build a filament along a random walk, which may cross itself.

    The angle at each joint is normally distributed with `deviation` rad.
    """
    straight = chain(nodes, spacing, **stiffness)
    if not (np.isfinite(deviation) and deviation >= 0):
        raise InvalidField("deviation", f"must be finite and at least 0, got {deviation}.")
    turns = deviation * np.random.default_rng(seed).standard_normal(nodes - 2)
    angle = np.concatenate([[0.0], np.cumsum(turns)])
    steps = spacing * np.stack([exact.cosine(angle), exact.sine(angle)], 1)
    positions = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, 0)])
    return replace(straight, positions=positions, rest_angle=turns, crossing=True)


def ring(nodes: int, spacing: float, **stiffness: Unpack[Stiffness]) -> Body:
    """Build a closed circle, anticlockwise from the node furthest along x."""
    _refuse_fewer("nodes", nodes, 3)
    number, turn = np.arange(nodes), 2 * np.pi / nodes
    places = _on_circle(number * turn, turn, spacing)
    edges = np.stack([number, (number + 1) % nodes], 1)
    return from_edges(places, edges, number / nodes, **stiffness)


def arc(nodes: int, spacing: float, gap: float, **stiffness: Unpack[Stiffness]) -> Body:
    """Build a circle with its share `gap` missing about the x axis, anticlockwise."""
    _refuse_fewer("nodes", nodes, 2)
    if not 0 < gap < 1:
        raise InvalidField("gap", f"must be between 0 and 1, got {gap:g}.")
    number, turn = np.arange(nodes), 2 * np.pi * (1 - gap) / (nodes - 1)
    places = _on_circle(np.pi * gap + number * turn, turn, spacing)
    edges = np.stack([number[:-1], number[1:]], 1)
    return from_edges(places, edges, number / (nodes - 1), **stiffness)


def _on_circle(angle: np.ndarray, turn: float, spacing: float) -> np.ndarray:
    """Return positions at `angle` on the circle on which `turn` makes a chord of `spacing`."""
    radius = 0.5 * spacing / exact.sine(turn / 2)
    return radius * np.stack([exact.cosine(angle), exact.sine(angle)], 1)


def star(arms: int, arm_nodes: int, spacing: float, **stiffness: Unpack[Stiffness]) -> Body:
    """Build straight arms of `arm_nodes` nodes, evenly about the first node in the middle."""
    _refuse_fewer("arms", arms, 1)
    _refuse_fewer("arm_nodes", arm_nodes, 1)
    turn = 2 * np.pi * np.arange(arms) / arms
    along = spacing * np.arange(1, arm_nodes + 1)
    arm_positions = (
        np.stack([exact.cosine(turn), exact.sine(turn)], 1)[:, None] * along[None, :, None]
    )
    outer = 1 + np.arange(arms * arm_nodes).reshape(arms, arm_nodes)
    inner = np.concatenate([np.zeros((arms, 1), int), outer[:, :-1]], 1)
    positions = np.concatenate([np.zeros((1, 2)), arm_positions.reshape(-1, 2)])
    return from_edges(positions, np.stack([inner.ravel(), outer.ravel()], 1), **stiffness)


def tree(
    levels: int,
    branches: int,
    segment_nodes: int,
    spacing: float,
    angle: float,
    **stiffness: Unpack[Stiffness],
) -> Body:
    """Build a stem along x that forks into `branches` at the end of every level.

    A segment adds `segment_nodes` nodes; `angle` in radians lies between the outermost
    branches of the first fork and narrows with every level. The first node is the root.
    """
    for name, value in (("levels", levels), ("branches", branches)):
        _refuse_fewer(name, value, 1)
    _refuse_fewer("segment_nodes", segment_nodes, 1)
    spread = angle * (np.linspace(-0.5, 0.5, branches) if branches > 1 else np.zeros(1))
    positions, edges, tips = [np.zeros(2)], [], [(0, 0.0)]
    for level in range(levels):
        turns = FORK_ANGLE_RATIO ** (level - 1) * spread if level else np.zeros(1)
        tips = [
            _segment(positions, edges, tip, heading + turn, segment_nodes, spacing)
            for tip, heading in tips
            for turn in turns
        ]
    return from_edges(np.array(positions), np.array(edges), **stiffness)


def _segment(
    positions: list, edges: list, start: int, heading: float, nodes: int, spacing: float
) -> tuple[int, float]:
    """Append a straight segment; return its tip and heading."""
    step = spacing * np.array([exact.cosine(heading), exact.sine(heading)])
    origin, tip = positions[start], start
    for number in range(1, nodes + 1):
        edges.append((tip, len(positions)))
        tip = len(positions)
        positions.append(origin + number * step)
    return tip, heading


def _refuse_fewer(name: str, value: int, least: int) -> None:
    if value < least:
        raise InvalidField(name, f"must be at least {least}, got {value}.")


def graph(
    nodes: Sequence[Any] | np.ndarray,
    edges: Sequence[Any] | np.ndarray,
    **stiffness: Unpack[Stiffness],
) -> Body:
    """Build filaments from positions in cells and pairs of node numbers, at rest as drawn."""
    return from_edges(rows_of_two("nodes", nodes), np.asarray(edges), **stiffness)


def from_graph(
    graph: Any, *, stretch: float = 1.0, shear: float = 1.0, bend: float = 1.0
) -> Body:
    """Build the body of a networkx graph whose nodes have a position `pos` in cells.

    Edges may have their own `rest_length`, `stretch` or `shear`.
    """
    places = dict(graph.nodes(data="pos"))
    for name, place in places.items():
        if place is None or np.shape(place) != (2,):
            raise InvalidField(
                "pos", f"must be two numbers at each node, got {place!r} at {name!r}."
            )
    number = {name: i for i, name in enumerate(places)}
    ends = np.array([(number[a], number[b]) for a, b in graph.edges()], int).reshape(-1, 2)
    usual = {"rest_length": np.nan, "stretch": stretch, "shear": shear}
    own = {
        name: np.array([data.get(name, value) for _, _, data in graph.edges(data=True)], float)
        for name, value in usual.items()
    }
    return from_edges(np.array(list(places.values()), float), ends, **own, bend=bend)


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
        nodes, pairs = _strand(corners, spacing, closed)
        places.append(nodes)
        edges.append(pairs + used)
        used += len(nodes)
    if not places:
        raise InvalidField("text", "must hold an SVG path, got none.")
    joined, pairs = _join(np.concatenate(places), np.concatenate(edges), spacing / 2)
    return from_edges(joined, pairs, **stiffness)


def _refuse_curve(corners: np.ndarray, spacing: float) -> None:
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 2:
        raise InvalidField("points", f"must be at least two (x, y), got {corners.shape}.")
    if not np.isfinite(corners).all():
        raise InvalidField("points", "must be finite.")
    if not spacing > 0:
        raise InvalidField("spacing", f"must be positive, got {spacing:g}.")


def _strand(corners: np.ndarray, spacing: float, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    if closed:
        corners = np.concatenate([corners, corners[:1]])
    steps = np.diff(corners, axis=0)
    way = np.concatenate([[0], np.cumsum(exact.length(steps[:, 0], steps[:, 1]))])
    if way[-1] == 0:
        raise InvalidField("points", "must not all be the same.")
    count = max(round(way[-1] / spacing), 3 if closed else 1)
    at = np.linspace(0, way[-1], count + 1)[: count + (not closed)]
    places = np.stack([np.interp(at, way, x) for x in corners.T], 1)
    number = np.arange(count)
    return places, np.stack([number, (number + 1) % len(places)], 1)


def _strands(text: str) -> list[tuple[np.ndarray, bool]]:
    """Return the points of every unbroken part of the SVG, and a flag of closed parts."""
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
    # In SVG y points down.
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
