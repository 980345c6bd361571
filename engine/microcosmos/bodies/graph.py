"""Bodies: nodes, edges and joints as NumPy data; checks, colouring, placement, combination."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from .. import exact
from ..invalid import InvalidField

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
    """Raise `ValueError` if `arrays` do not describe a body."""
    _refuse_shapes(arrays)
    _refuse_values(arrays)
    _refuse_members(arrays["member"])
    _refuse_edges(arrays["edges"], arrays["positions"], arrays["member"])
    # After the edges: one between two nodes in the same place has no length of its own.
    if (shortest := arrays["rest_length"].min()) <= 0:
        raise InvalidField("rest_length", f"must be positive, got {shortest:g}.")
    _refuse_joints(arrays["joints"], arrays["edges"])
    if not arrays["crossing"]:
        refuse_crowding(arrays["positions"])


def refuse_crowding(positions: np.ndarray) -> None:
    """Raise `ValueError` if two nodes are nearer than `MIN_GAP`.

    Such a pair shares a cell of width 2 `MIN_GAP` in one of four shifted grids, so that no
    search over all pairs is needed.
    """
    for shift in ((0, 0), (0, 1), (1, 0), (1, 1)):
        cell = np.floor((positions / MIN_GAP + np.array(shift)) / 2)
        order = np.lexsort((cell[:, 1], cell[:, 0]))
        cell, near = cell[order], positions[order]
        # Few nodes that keep their distance fit into a cell, so the loop soon ends.
        for lag in range(1, len(positions)):
            shared = np.all(cell[lag:] == cell[:-lag], 1)
            if not shared.any():
                break
            gap = np.hypot(*(near[lag:] - near[:-lag]).T)
            close = np.flatnonzero(shared & (gap < MIN_GAP))
            if len(close):
                pair = sorted((int(order[close[0]]), int(order[close[0] + lag])))
                raise InvalidField(
                    "positions",
                    f"must be at least {MIN_GAP} cells apart, nodes {pair[0]} and "
                    f"{pair[1]} are {gap[close[0]]:.3g} apart.",
                )


def _refuse_shapes(arrays: Mapping[str, np.ndarray]) -> None:
    counts = {name: len(arrays[f"{name}s"]) for name in ("edge", "joint")}
    counts["node"] = len(arrays["positions"])
    if counts["node"] < 2 or counts["edge"] < 1:
        raise InvalidField(
            "positions",
            "and `edges` must hold at least two nodes and one edge, got "
            f"{counts['node']} and {counts['edge']}.",
        )
    for name, shape in SHAPES.items():
        expected = tuple(counts[s] if isinstance(s, str) else s for s in shape)
        if arrays[name].shape != expected:
            raise InvalidField(name, f"must be {expected}, got {arrays[name].shape}.")
        if name in WHOLE and arrays[name].dtype.kind not in "iu":
            raise InvalidField(name, f"must be whole numbers, got {arrays[name].dtype}.")


def _refuse_values(arrays: Mapping[str, np.ndarray]) -> None:
    for name in (name for name in SHAPES if name not in WHOLE):
        if len(infinite := arrays[name][~np.isfinite(arrays[name])]):
            raise InvalidField(name, f"must be finite, got {infinite[0]}.")
    for name in ("stretch", "shear", "bend"):
        low, high = arrays[name].min(initial=1), arrays[name].max(initial=0)
        if low < 0 or high > 1:
            raise InvalidField(name, f"must be from 0 to 1, got {low if low < 0 else high:g}.")


def _refuse_members(member: np.ndarray) -> None:
    if member[0] != 0 or not np.isin(np.diff(member), (0, 1)).all():
        raise InvalidField(
            "member", "must number creatures 0, 1, 2 … in the order of their nodes."
        )


def _refuse_edges(edges: np.ndarray, positions: np.ndarray, member: np.ndarray) -> None:
    _refuse_pairs("edges", edges, "nodes", len(positions))
    first, second = edges.T
    length = np.hypot(*(positions[second] - positions[first]).T)
    if not length.all():
        raise InvalidField("edges", f"must have a length, edge {np.argmin(length)} has none.")
    if (apart := member[first] != member[second]).any():
        raise InvalidField(
            "edges",
            f"must join nodes of one creature, edge {np.argmax(apart)} joins "
            f"creatures {member[first][apart][0]} and {member[second][apart][0]}.",
        )
    if (np.diff(member[first]) < 0).any():
        raise InvalidField("edges", "must be in the order of their creatures.")


def _refuse_joints(joints: np.ndarray, edges: np.ndarray) -> None:
    _refuse_pairs("joints", joints, "edges", len(edges))
    first, second = edges[joints[:, 0]], edges[joints[:, 1]]
    meets = (first[:, :, None] == second[:, None, :]).any((1, 2))
    if not meets.all():
        number = np.argmin(meets)
        raise InvalidField(
            "joints",
            f"must join edges that share a node, joint {number} joins edges "
            f"{joints[number, 0]} and {joints[number, 1]}.",
        )


def _refuse_pairs(name: str, pairs: np.ndarray, of: str, count: int) -> None:
    if not pairs.size:
        return
    low, high = pairs.min(), pairs.max()
    if low < 0 or high >= count:
        raise InvalidField(
            name, f"must be pairs of {of} 0 to {count - 1}, got {low if low < 0 else high}."
        )
    if (same := pairs[:, 0] == pairs[:, 1]).any():
        number = np.argmax(same)
        raise InvalidField(
            name, f"must be pairs of different {of}, pair {number} is {pairs[number, 0]} twice."
        )
    # One number for each pair, whichever of its members comes first.
    key = np.sort(pairs.min(1) * count + pairs.max(1))
    if (twice := key[1:] == key[:-1]).any():
        first, second = divmod(int(key[1:][twice][0]), count)
        raise InvalidField(name, f"must differ, got {of} {first} and {second} twice.")


@dataclass(frozen=True)
class Colour:
    """Constraints that share no member, listed for every member.

    `sign` is 1 for the first of a pair, −1 for the second, and 0 where no constraint of
    this colour touches the member.
    """

    partner: np.ndarray
    constraint: np.ndarray
    sign: np.ndarray


def colour(pairs: np.ndarray, part: np.ndarray) -> tuple[Colour, ...]:
    """Colour pairs greedily: each gets the first colour that neither member has yet.

    `part` is the part of the graph of each member, ascending; no pair joins two parts.
    """
    # Parts with the same pairs are coloured once: a crowd of equal creatures costs little more.
    owner = part[pairs[:, 0]]
    order = np.argsort(owner, kind="stable")
    bounds = np.searchsorted(owner[order], np.arange(part[-1] + 2))
    start = np.searchsorted(part, np.arange(part[-1] + 2))
    local = pairs[order] - start[owner[order]][:, None]
    known: dict[bytes, np.ndarray] = {}
    chosen = np.zeros(len(pairs), int)
    for i, (first, last) in enumerate(pairwise(bounds.tolist())):
        pairs_of_part = local[first:last]
        name = pairs_of_part.tobytes()
        if name not in known:
            known[name] = _greedy(pairs_of_part, int(start[i + 1] - start[i]))
        chosen[order[first:last]] = known[name]
    colours = range(chosen.max(initial=-1) + 1)
    return tuple(_pairing(pairs, np.flatnonzero(chosen == c), len(part)) for c in colours)


def _greedy(pairs: np.ndarray, members: int) -> np.ndarray:
    taken: list[set[int]] = [set() for _ in range(members)]
    chosen = np.zeros(len(pairs), int)
    for number, (first, second) in enumerate(pairs.tolist()):
        used = taken[first] | taken[second]
        chosen[number] = next(c for c in range(len(used) + 1) if c not in used)
        taken[first].add(int(chosen[number]))
        taken[second].add(int(chosen[number]))
    return chosen


def _pairing(pairs: np.ndarray, group: np.ndarray, members: int) -> Colour:
    partner = np.arange(members)
    constraint = np.zeros(members, int)
    sign = np.zeros(members)
    first, second = pairs[group].T
    partner[first], partner[second] = second, first
    constraint[first] = constraint[second] = group
    sign[first], sign[second] = 1, -1
    return Colour(partner, constraint, sign)


@dataclass(frozen=True)
class Body:
    """Filaments at rest, in cells and radians, of one creature or several."""

    positions: np.ndarray
    """(node, 2)."""
    edges: np.ndarray
    """(edge, 2) node numbers; an edge's direction is from the first to the second."""
    joints: np.ndarray
    """(joint, 2) numbers of edges that share a node."""
    rest_length: np.ndarray
    rest_angle: np.ndarray
    """(joint,) direction of the second edge minus that of the first."""
    stretch: np.ndarray
    shear: np.ndarray
    bend: np.ndarray
    arc: np.ndarray
    """(node,) position along the creature from 0 to 1."""
    member: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    """(node,) creature of each node, ascending from 0; one creature if left out."""
    crossing: bool = False
    """True if filaments may cross, with nodes nearer than `MIN_GAP`."""

    def __post_init__(self):
        if not len(self.member):
            object.__setattr__(self, "member", np.zeros(len(self.positions), int))
        refuse_malformed(vars(self))

    @property
    def count(self) -> int:
        """Return the number of creatures."""
        return int(self.member[-1]) + 1

    @cached_property
    def joint_nodes(self) -> np.ndarray:
        """Return the node (joint,) that the two edges share."""
        first, second = self.edges[self.joints[:, 0]], self.edges[self.joints[:, 1]]
        shared = (first[:, :, None] == second[:, None, :]).any(2)
        return np.where(shared[:, 0], first[:, 0], first[:, 1])

    @cached_property
    def edge_colours(self) -> tuple[Colour, ...]:
        return colour(self.edges, self.member)

    @cached_property
    def joint_colours(self) -> tuple[Colour, ...]:
        if not len(self.joints):
            return ()
        return colour(self.joints, self.member[self.edges[:, 0]])


INDEXED_BY = {"edges": "positions", "joints": "edges"}


def placed(body: Body, centre: Sequence[int | float] | np.ndarray, turned: float = 0.0) -> Body:
    """Turn a body anticlockwise about its mean node position and move that to `centre`."""
    c, s = exact.cosine(turned), exact.sine(turned)
    arms = body.positions - body.positions.mean(0)
    x, y = arms.T
    rotated = np.stack([c * x - s * y, s * x + c * y], 1) if turned else arms
    return replace(body, positions=rotated + np.asarray(centre, float))


def combined(bodies: Sequence[Body]) -> Body:
    """Combine bodies into one, their creatures numbered in turn."""
    if not bodies:
        raise InvalidField("bodies", "must hold at least one body, got none.")
    arrays = {}
    for name in (f.name for f in fields(Body) if f.name != "crossing"):
        parts = [getattr(body, name) for body in bodies]
        arrays[name] = np.concatenate(parts)
        if name in INDEXED_BY:
            sizes = [len(getattr(body, INDEXED_BY[name])) for body in bodies]
            arrays[name] = arrays[name] + _offsets(sizes, parts)[:, None]
    counts = [body.count for body in bodies]
    arrays["member"] = arrays["member"] + _offsets(counts, [b.member for b in bodies])
    return Body(**arrays, crossing=any(body.crossing for body in bodies))


def _offsets(sizes: list[int], parts: list[np.ndarray]) -> np.ndarray:
    """Return, for each entry of the joined parts, the sizes of the bodies before it."""
    return np.repeat(np.cumsum([0, *sizes[:-1]]), [len(part) for part in parts])
