"""Graphs: order, depth, reachable nodes."""

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Sequence
from heapq import heappop, heappush

Pairs = Sequence[tuple[int, int]]
"""Sources and targets."""


def order(keys: Sequence[int], pairs: Pairs) -> list[int]:
    """Sort sources before their targets, otherwise as keys stand (Kahn's algorithm).

    Raises `ValueError` if there is a cycle.
    """
    row = {key: place for place, key in enumerate(keys)}
    waiting, targets = Counter(target for _, target in pairs), _targets(pairs)
    ready = [row[key] for key in keys if not waiting[key]]  # Ascending, so it is a heap.
    ordered = []
    while ready:
        key = keys[heappop(ready)]
        ordered.append(key)
        for target in targets[key]:
            waiting[target] -= 1
            if not waiting[target]:
                heappush(ready, row[target])
    if left := sorted(set(keys) - set(ordered)):
        raise ValueError(
            "connections of a feed-forward network must be free of cycles, "
            f"got one that holds or leads to {', '.join(map(str, left[:5]))}"
        )
    return ordered


def _targets(pairs: Pairs) -> defaultdict[int, list[int]]:
    targets: defaultdict[int, list[int]] = defaultdict(list)
    for source, target in pairs:
        targets[source].append(target)
    return targets


def reached(starts: Iterable[int], pairs: Pairs) -> set[int]:
    """Return the starts and every key that a path leads to from them."""
    targets, found = _targets(pairs), set(starts)
    waiting = list(found)
    while waiting:
        new = set(targets[waiting.pop()]) - found
        found |= new
        waiting.extend(new)
    return found


def depths(keys: Sequence[int], pairs: Pairs) -> dict[int, int]:
    """Return the longest path to each key along the connections that close no cycle."""
    back = closing(keys, pairs)
    forward = [pair for pair in pairs if pair not in back]
    depth: dict[int, int] = {}
    sources = _targets([(target, source) for source, target in forward])
    for key in order(keys, forward):
        depth[key] = max((depth[source] + 1 for source in sources[key]), default=0)
    return depth


def closing(keys: Sequence[int], pairs: Pairs) -> Collection[tuple[int, int]]:
    """Return the connections that close a cycle: back edges of a depth-first search."""
    targets, state, found = _targets(pairs), {}, set()
    for start in keys:
        if start in state:
            continue
        state[start] = "open"
        way = [(start, iter(targets[start]))]
        while way:
            key, rest = way[-1]
            target = next(rest, None)
            if target is None:
                state[key] = "closed"
                way.pop()
            elif target not in state:
                state[target] = "open"
                way.append((target, iter(targets[target])))
            elif state[target] == "open":
                found.add((key, target))
    return found
