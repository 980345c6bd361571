"""Colouring of constraints: constraints of one colour share no member and act at once."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np


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

    `part` is the part of the graph of each member, ascending; no pair joins two parts, and
    equal parts are coloured once.
    """
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
