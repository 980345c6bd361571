"""Bodies as graphs: nodes, edges and joints as NumPy data, coloured once."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Colour:
    """Constraints that share no member, seen from every member.

    `sign` is 1 for the first of a pair, −1 for the second, and 0 where no constraint of
    this colour touches the member.
    """

    partner: np.ndarray
    constraint: np.ndarray
    sign: np.ndarray


@dataclass(frozen=True)
class Body:
    """A creature's filaments at rest, in cells and radians."""

    positions: np.ndarray
    """(node, 2), the first node at the origin."""
    edges: np.ndarray
    """(edge, 2) node numbers."""
    joints: np.ndarray
    """(joint, 2) edge numbers; the first edge ends where the second begins."""
    rest_length: np.ndarray
    rest_angle: np.ndarray
    stretch: np.ndarray
    shear: np.ndarray
    bend: np.ndarray
    arc: np.ndarray
    """(node,) position along the filament from 0 to 1."""

    @property
    def edge_colours(self) -> tuple[Colour, ...]:
        return colour(self.edges, len(self.positions))

    @property
    def joint_colours(self) -> tuple[Colour, ...]:
        return colour(self.joints, len(self.edges))


def colour(pairs: np.ndarray, members: int) -> tuple[Colour, ...]:
    """Greedy colouring: each pair gets the first colour that neither member has yet."""
    taken: list[set[int]] = [set() for _ in range(members)]
    groups: list[list[int]] = []
    for number, (first, second) in enumerate(pairs.tolist()):
        used = taken[first] | taken[second]
        chosen = next(c for c in range(len(groups) + 1) if c not in used)
        if chosen == len(groups):
            groups.append([])
        groups[chosen].append(number)
        taken[first].add(chosen)
        taken[second].add(chosen)
    return tuple(_seen_from_members(pairs, group, members) for group in groups)


def _seen_from_members(pairs: np.ndarray, group: list[int], members: int) -> Colour:
    partner = np.arange(members)
    constraint = np.zeros(members, int)
    sign = np.zeros(members)
    first, second = pairs[group].T
    partner[first], partner[second] = second, first
    constraint[first] = constraint[second] = group
    sign[first], sign[second] = 1, -1
    return Colour(partner, constraint, sign)
