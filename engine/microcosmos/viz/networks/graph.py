"""Graphs: order, depth, reachable nodes."""

from collections.abc import Collection, Iterable, Sequence
from heapq import heapify, heappop, heappush

Pairs = Sequence[tuple[int, int]]
"""Sources and targets."""


def order(keys: Sequence[int], pairs: Pairs) -> list[int]:
    """Keys with every source before its targets, otherwise as they stand (Kahn's algorithm).

    Raises `ValueError` if there is a cycle.
    """
    ordered = partial_order(keys, pairs)
    if len(ordered) < len(keys):
        left = sorted(set(keys) - set(ordered))
        raise ValueError(
            "connections of a feed-forward network must be free of cycles, "
            f"got one that holds or leads to {', '.join(map(str, left[:5]))}"
        )
    return ordered


def partial_order(keys: Sequence[int], pairs: Pairs) -> list[int]:
    """Return the order without the nodes on a cycle or behind one."""
    row = {key: place for place, key in enumerate(keys)}
    waiting = dict.fromkeys(keys, 0)
    targets: dict[int, list[int]] = {key: [] for key in keys}
    for source, target in pairs:
        waiting[target] += 1
        targets[source].append(target)
    ready = [row[key] for key in keys if not waiting[key]]
    heapify(ready)
    ordered = []
    while ready:
        key = keys[heappop(ready)]
        ordered.append(key)
        for target in targets[key]:
            waiting[target] -= 1
            if not waiting[target]:
                heappush(ready, row[target])
    return ordered


def reached(starts: Iterable[int], pairs: Pairs) -> set[int]:
    """Return the starts and every key that a path leads to from them."""
    targets: dict[int, list[int]] = {}
    for source, target in pairs:
        targets.setdefault(source, []).append(target)
    found = set(starts)
    waiting = list(found)
    while waiting:
        for target in targets.get(waiting.pop(), ()):
            if target not in found:
                found.add(target)
                waiting.append(target)
    return found


def depths(keys: Sequence[int], pairs: Pairs) -> dict[int, int]:
    """Return the longest path to each key along the connections that close no cycle."""
    back = closing(keys, pairs)
    forward = [pair for pair in pairs if pair not in back]
    depth = dict.fromkeys(keys, 0)
    sources: dict[int, list[int]] = {key: [] for key in keys}
    for source, target in forward:
        sources[target].append(source)
    for key in order(keys, forward):
        depth[key] = max((depth[source] + 1 for source in sources[key]), default=0)
    return depth


def closing(keys: Sequence[int], pairs: Pairs) -> Collection[tuple[int, int]]:
    """Connections that close a cycle: back edges of a depth-first search."""
    targets: dict[int, list[int]] = {key: [] for key in keys}
    for source, target in pairs:
        targets[source].append(target)
    state: dict[int, str] = {}
    found = set()
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
