"""Checks of the arrays of a body."""

from collections.abc import Mapping
from typing import Any

import numpy as np

MIN_GAP = 0.25
"""Least distance of two nodes in cells. At this gap their four-point deltas overlap to 97 %;
below it, the forces at the two nodes grow without changing the flow."""

SHAPES = {
    "positions": ("node", 2),
    "edges": ("edge", 2),
    "joints": ("joint", 2),
    "rest_length": ("edge",),
    "rest_angle": ("joint",),
    "stretch": ("edge",),
    "shear": ("edge",),
    "bend": ("joint",),
    "arc": ("node",),
    "member": ("node",),
}
WHOLE = ("edges", "joints", "member")


def refuse_malformed(arrays: Mapping[str, Any]) -> None:
    """Raise `ValueError` where `arrays` do not describe a body."""
    _refuse_shapes(arrays)
    _refuse_values(arrays)
    _refuse_members(arrays["member"])
    _refuse_edges(arrays["edges"], arrays["positions"], arrays["member"])
    _refuse_joints(arrays["joints"], arrays["edges"])
    if not arrays["crossing"]:
        refuse_crowding(arrays["positions"])


def refuse_crowding(positions: np.ndarray) -> None:
    """Raise `ValueError` where two nodes are nearer than `MIN_GAP`.

    Such a pair shares a cell of width 2 `MIN_GAP` in one of four shifted grids, and few
    nodes that keep their distance fit into a cell.
    """
    for shift in ((0, 0), (0, 1), (1, 0), (1, 1)):
        cell = np.floor((positions / MIN_GAP + np.array(shift)) / 2)
        order = np.lexsort((cell[:, 1], cell[:, 0]))
        cell, near = cell[order], positions[order]
        for lag in range(1, len(positions)):
            shared = np.all(cell[lag:] == cell[:-lag], 1)
            if not shared.any():
                break
            gap = np.hypot(*(near[lag:] - near[:-lag]).T)
            close = np.flatnonzero(shared & (gap < MIN_GAP))
            if len(close):
                pair = sorted((int(order[close[0]]), int(order[close[0] + lag])))
                raise ValueError(
                    f"`positions` must be at least {MIN_GAP} cells apart, nodes {pair[0]} and "
                    f"{pair[1]} are {gap[close[0]]:.3g} apart."
                )


def _refuse_shapes(arrays: Mapping[str, np.ndarray]) -> None:
    counts = {name: len(arrays[f"{name}s"]) for name in ("edge", "joint")}
    counts["node"] = len(arrays["positions"])
    if counts["node"] < 2 or counts["edge"] < 1:
        raise ValueError(
            "`positions` and `edges` must hold at least two nodes and one edge, got "
            f"{counts['node']} and {counts['edge']}."
        )
    for name, shape in SHAPES.items():
        expected = tuple(counts[s] if isinstance(s, str) else s for s in shape)
        if arrays[name].shape != expected:
            raise ValueError(f"`{name}` must be {expected}, got {arrays[name].shape}.")
        if name in WHOLE and arrays[name].dtype.kind not in "iu":
            raise ValueError(f"`{name}` must be whole numbers, got {arrays[name].dtype}.")


def _refuse_values(arrays: Mapping[str, np.ndarray]) -> None:
    for name in (name for name in SHAPES if name not in WHOLE):
        if len(infinite := arrays[name][~np.isfinite(arrays[name])]):
            raise ValueError(f"`{name}` must be finite, got {infinite[0]}.")
    for name in ("stretch", "shear", "bend"):
        low, high = arrays[name].min(initial=1), arrays[name].max(initial=0)
        if low < 0 or high > 1:
            raise ValueError(f"`{name}` must be from 0 to 1, got {low if low < 0 else high:g}.")
    if (shortest := arrays["rest_length"].min()) <= 0:
        raise ValueError(f"`rest_length` must be positive, got {shortest:g}.")


def _refuse_members(member: np.ndarray) -> None:
    if member[0] != 0 or not np.isin(np.diff(member), (0, 1)).all():
        raise ValueError(
            "`member` must number creatures 0, 1, 2 … in the order of their nodes."
        )


def _refuse_edges(edges: np.ndarray, positions: np.ndarray, member: np.ndarray) -> None:
    _refuse_pairs("edges", edges, "nodes", len(positions))
    first, second = edges.T
    length = np.hypot(*(positions[second] - positions[first]).T)
    if not length.all():
        raise ValueError(f"`edges` must have a length, edge {np.argmin(length)} has none.")
    if (apart := member[first] != member[second]).any():
        raise ValueError(
            f"`edges` must join nodes of one creature, edge {np.argmax(apart)} joins "
            f"creatures {member[first][apart][0]} and {member[second][apart][0]}."
        )
    if (np.diff(member[first]) < 0).any():
        raise ValueError("`edges` must be in the order of their creatures.")


def _refuse_joints(joints: np.ndarray, edges: np.ndarray) -> None:
    _refuse_pairs("joints", joints, "edges", len(edges))
    first, second = edges[joints[:, 0]], edges[joints[:, 1]]
    meets = (first[:, :, None] == second[:, None, :]).any((1, 2))
    if not meets.all():
        number = np.argmin(meets)
        raise ValueError(
            f"`joints` must join edges that share a node, joint {number} joins edges "
            f"{joints[number, 0]} and {joints[number, 1]}."
        )


def _refuse_pairs(name: str, pairs: np.ndarray, of: str, count: int) -> None:
    if not pairs.size:
        return
    low, high = pairs.min(), pairs.max()
    if low < 0 or high >= count:
        raise ValueError(
            f"`{name}` must be pairs of {of} 0 to {count - 1}, got {low if low < 0 else high}."
        )
    if (same := pairs[:, 0] == pairs[:, 1]).any():
        number = np.argmax(same)
        raise ValueError(
            f"`{name}` must be pairs of different {of}, pair {number} is "
            f"{pairs[number, 0]} twice."
        )
    key = np.sort(pairs.min(1) * count + pairs.max(1))
    if (twice := key[1:] == key[:-1]).any():
        first, second = divmod(int(key[1:][twice][0]), count)
        raise ValueError(f"`{name}` must differ, got {of} {first} and {second} twice.")
