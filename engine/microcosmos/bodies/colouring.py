"""Colouring of constraints: those of one colour share no member, so that they act at once."""

from dataclasses import dataclass
from itertools import pairwise

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


def colour(pairs: np.ndarray, members: int) -> tuple[Colour, ...]:
    """Greedy colouring: each pair gets the first colour that neither member has yet."""
    return _seen_from_members(pairs, _greedy(pairs, members), members)


def colour_parts(pairs: np.ndarray, part: np.ndarray) -> tuple[Colour, ...]:
    """The same for a graph whose members belong to separate parts; equal parts cost one.

    `part` is the part of each member, ascending; no pair joins two parts.
    """
    owner = part[pairs[:, 0]]
    order = np.argsort(owner, kind="stable")
    bounds = np.searchsorted(owner[order], np.arange(part[-1] + 2))
    start = np.searchsorted(part, np.arange(part[-1] + 2))
    local = pairs[order] - start[owner[order]][:, None]
    known: dict[bytes, np.ndarray] = {}
    chosen = np.zeros(len(pairs), int)
    for i, (first, last) in enumerate(pairwise(bounds.tolist())):
        own = local[first:last]
        name = own.tobytes()
        if name not in known:
            known[name] = _greedy(own, int(start[i + 1] - start[i]))
        chosen[order[first:last]] = known[name]
    return _seen_from_members(pairs, chosen, len(part))


def _greedy(pairs: np.ndarray, members: int) -> np.ndarray:
    taken: list[set[int]] = [set() for _ in range(members)]
    chosen = np.zeros(len(pairs), int)
    for number, (first, second) in enumerate(pairs.tolist()):
        used = taken[first] | taken[second]
        chosen[number] = next(c for c in range(len(used) + 1) if c not in used)
        taken[first].add(int(chosen[number]))
        taken[second].add(int(chosen[number]))
    return chosen


def _seen_from_members(
    pairs: np.ndarray, chosen: np.ndarray, members: int
) -> tuple[Colour, ...]:
    colours = range(chosen.max(initial=-1) + 1)
    return tuple(_pairing(pairs, np.flatnonzero(chosen == c), members) for c in colours)


def _pairing(pairs: np.ndarray, group: np.ndarray, members: int) -> Colour:
    partner = np.arange(members)
    constraint = np.zeros(members, int)
    sign = np.zeros(members)
    first, second = pairs[group].T
    partner[first], partner[second] = second, first
    constraint[first] = constraint[second] = group
    sign[first], sign[second] = 1, -1
    return Colour(partner, constraint, sign)
