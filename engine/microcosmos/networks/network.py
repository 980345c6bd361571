"""Networks as data in either of two conventions, their graphs, and their evaluation."""

from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from heapq import heappop, heappush
from math import inf, isfinite
from typing import Any, Literal

import numpy as np

from .functions import ACTIVATIONS, AGGREGATIONS

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


LARGEST_KEY = 2**24
"""TensorNEAT keeps keys as float32, exact only below this."""


@dataclass(frozen=True)
class Node:
    """z = bias + response × aggregation(messages); the value is activation(z)."""

    key: int
    bias: float = 0.0
    response: float = 1.0
    aggregation: str = "sum"
    activation: str = "identity"


@dataclass(frozen=True)
class Link:
    """A connection between keys, whose message is weight × value of the source."""

    source: int
    target: int
    weight: float
    marker: int | None = None
    """Historical number, if the network has them."""


@dataclass(frozen=True)
class Network:
    """Nodes by key, the inputs 0, 1, … among them, and links between keys.

    Values are kept within ±`bound`. Under the rule `live` (TensorNEAT's), a message counts
    only if its source has a value, and a node without messages has none: NaN. Under `always`
    (ours), a node without links computes activation(bias).

    `steps` is None for feed-forward; else the number of updates of all nodes together.
    """

    inputs: int
    outputs: tuple[int, ...]
    nodes: tuple[Node, ...]
    links: tuple[Link, ...]
    rule: Literal["live", "always"] = "live"
    steps: int | None = None
    output_transform: str | None = None
    """An activation for every output at the end, unseen by other nodes."""
    bound: float = inf
    input_names: tuple[str, ...] = ()
    output_names: tuple[str, ...] = ()

    def __post_init__(self):
        _check_nodes(self)
        _check_functions(self)
        _check_links(self)
        if self.rule not in ("live", "always"):
            raise ValueError(f"`rule` must be live or always, got {self.rule!r}")
        if self.steps is None:
            order(self.keys, self.pairs)
        elif self.steps < 1:
            raise ValueError(f"`steps` must be at least 1, got {self.steps}")

    @cached_property
    def keys(self) -> tuple[int, ...]:
        """Return the keys in the order of the nodes."""
        return tuple(node.key for node in self.nodes)

    @cached_property
    def node(self) -> dict[int, Node]:
        """Return the nodes by key."""
        return {node.key: node for node in self.nodes}

    @cached_property
    def incoming(self) -> dict[int, list[Link]]:
        """Return the links by target, in the order of their sources' nodes."""
        row = {key: place for place, key in enumerate(self.keys)}
        links: dict[int, list[Link]] = {key: [] for key in self.keys}
        for link in sorted(self.links, key=lambda link: row[link.source]):
            links[link.target].append(link)
        return links

    @property
    def marked(self) -> bool:
        """Return whether the links have historical numbers."""
        return bool(self.links) and all(link.marker is not None for link in self.links)

    @cached_property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Return the source and target of every link."""
        return tuple((link.source, link.target) for link in self.links)

    @property
    def hidden(self) -> tuple[int, ...]:
        """Return the keys of nodes that are neither input nor output."""
        return tuple(k for k in self.keys if k >= self.inputs and k not in self.outputs)

    @property
    def names(self) -> dict[int, str]:
        """Return the names of inputs and outputs by key."""
        inputs = self.input_names or tuple(f"input {i}" for i in range(self.inputs))
        outputs = self.output_names or tuple(f"output {i}" for i in range(len(self.outputs)))
        return dict(enumerate(inputs)) | dict(zip(self.outputs, outputs, strict=True))


def renumbered(network: Network, key: Callable[[int], int]) -> Network:
    """Return the network with every key mapped by `key`, nodes in the order of new keys."""
    nodes = [replace(node, key=key(node.key)) for node in network.nodes]
    return replace(
        network,
        outputs=tuple(map(key, network.outputs)),
        nodes=tuple(sorted(nodes, key=lambda node: node.key)),
        links=tuple(
            replace(link, source=key(link.source), target=key(link.target))
            for link in network.links
        ),
    )


def outputs_first(network: Network) -> Network:
    """Number outputs after inputs and hidden nodes after outputs."""
    fixed = {key: network.inputs + place for place, key in enumerate(network.outputs)}

    def key(old: int) -> int:
        if old < network.inputs:
            return old
        return fixed.get(old, old + sum(output > old for output in network.outputs))

    return renumbered(network, key)


def delegated(network: Network, output: int, activation: str) -> Network:
    """Move an output's node to a new hidden one, which the output reads with the activation."""
    new = max(network.keys) + 1
    moved = replace(network.node[output], key=new)
    nodes = [node if node.key != output else Node(output) for node in network.nodes]
    nodes = [replace(n, activation=activation) if n.key == output else n for n in nodes]

    def instead(key: int) -> int:
        return new if key == output else key

    links = [Link(instead(x.source), instead(x.target), x.weight) for x in network.links]
    return replace(network, nodes=(*nodes, moved), links=(*links, Link(new, output, 1.0)))


def _check_nodes(network: Network) -> None:
    keys, outputs = network.keys, network.outputs
    _refuse(_repeated(keys), "`keys` must differ, got")
    _refuse([k for k in keys if not 0 <= k < 2**31], "`keys` must be from 0 to 2³¹ − 1, got")
    if network.inputs < 1 or not outputs:
        raise ValueError("`inputs` and `outputs` must be at least one each, got none")
    inside = [key for key in outputs if key < network.inputs]
    _refuse(
        _repeated(outputs) or inside, "`outputs` must differ from inputs and each other, got"
    )
    missing = {*range(network.inputs), *outputs} - set(keys)
    _refuse(missing, "`keys` must hold all inputs and outputs, misses")
    _refuse_infinite("bias", [node.bias for node in network.nodes])
    _refuse_infinite("response", [node.response for node in network.nodes])
    for field, names, needed in (
        ("input_names", network.input_names, network.inputs),
        ("output_names", network.output_names, len(outputs)),
    ):
        if names and len(names) != needed:
            raise ValueError(f"`{field}` must be none or {needed}, got {len(names)}")


def _check_functions(network: Network) -> None:
    activations = {node.activation for node in network.nodes} - set(ACTIVATIONS)
    _refuse(activations, f"`activation` must be among {list(ACTIVATIONS)}, got")
    aggregations = {node.aggregation for node in network.nodes} - set(AGGREGATIONS)
    _refuse(aggregations, f"`aggregation` must be among {list(AGGREGATIONS)}, got")
    if network.output_transform not in (None, *ACTIVATIONS):
        raise ValueError(
            f"`output_transform` must be none or among {list(ACTIVATIONS)}, "
            f"got {network.output_transform!r}"
        )


def _check_links(network: Network) -> None:
    markers = [link.marker for link in network.links if link.marker is not None]
    _refuse(_repeated(markers), "`marker` must differ, got twice")
    targets = [link.target for link in network.links]
    missing = {*targets, *(link.source for link in network.links)} - set(network.keys)
    _refuse(missing, "connections must join existing nodes, got")
    _refuse([k for k in targets if k < network.inputs], "`target` must not be an input, got")
    _refuse(_repeated(network.pairs), "connections must join a pair of nodes once, got twice")
    _refuse_infinite("weight", [link.weight for link in network.links])


def _refuse_infinite(field: str, values: list[float]) -> None:
    _refuse(
        [value for value in values if not isfinite(value)], f"`{field}` must be finite, got"
    )


def _repeated(items: Iterable[Any]) -> list[Any]:
    return [item for item, count in Counter(items).items() if count > 1]


def _refuse(wrong: Collection[Any], needed: str) -> None:
    """Raise `ValueError` with the first of the wrong items, if there are any."""
    if wrong:
        raise ValueError(f"{needed} {', '.join(map(str, sorted(wrong)[:5]))}")


TOLERANCE = 1e-6
"""Largest difference of equal networks, relative to max(1, |value|)."""


def evaluate(network: Network, inputs: np.ndarray) -> np.ndarray:
    """Return outputs (output, point) for inputs (input, point), NaN where there is no value."""
    inputs = np.asarray(inputs, float)
    if inputs.ndim != 2 or len(inputs) != network.inputs:
        raise ValueError(f"`inputs` must be ({network.inputs}, points), got {inputs.shape}")
    # In TensorNEAT a node that no message reaches has no value
    # (test_values_are_those_of_tensorneat_in_double_precision_nan_included).
    start = np.nan if network.rule == "live" else 0.0
    values = {key: np.full(inputs.shape[1], start) for key in network.keys}
    values.update(enumerate(inputs))
    keys = network.keys if network.steps else order(network.keys, network.pairs)
    nodes = [network.node[key] for key in keys if key >= network.inputs]
    # Values beyond the range of doubles become infinite or NaN, as in TensorNEAT.
    with np.errstate(all="ignore"):
        if network.steps is None:
            for node in nodes:
                values[node.key] = _value(network, node, values)
        for _ in range(network.steps or 0):
            values |= {node.key: _value(network, node, values) for node in nodes}
        outputs = np.stack([values[key] for key in network.outputs])
        return ACTIVATIONS[network.output_transform or "identity"](outputs)


def probes(inputs: int) -> np.ndarray:
    """Return inputs (input, point) for comparisons: all 0, all 1, the rest normal."""
    # The same inputs always: a check must not fail by chance.
    drawn = np.random.default_rng(0).normal(size=(inputs, 256))
    drawn[:, 0], drawn[:, 1] = 0.0, 1.0
    return drawn


def agree(one: np.ndarray, other: np.ndarray, tolerance: float = TOLERANCE) -> bool:
    """Return whether values agree within the tolerance, NaN and infinity at the same places."""
    with np.errstate(invalid="ignore"):
        close = np.abs(one - other) <= tolerance * np.maximum(1, np.abs(one))
    same = (one == other) | (np.isnan(one) & np.isnan(other))
    return bool(np.all(same | (close & np.isfinite(one))))


def require_agreement(what: str, one: Network, other: Network) -> None:
    """Raise `ValueError` unless both networks compute the same for 256 random inputs."""
    inputs = probes(one.inputs)
    before, after = evaluate(one, inputs), evaluate(other, inputs)
    if not agree(before, after):
        with np.errstate(all="ignore"):
            worst = np.nanmax(np.abs(before - after) / np.maximum(1, np.abs(before)))
        bound = min(one.bound, other.bound)
        reason = f" (only one of the two keeps values within ±{bound:g})"
        raise ValueError(
            f"{what} must compute the same within {TOLERANCE:g} of max(1, |value|), "
            f"got a difference of {worst:.3g}{reason * (one.bound != other.bound)}"
        )


def _value(network: Network, node: Node, values: dict[int, np.ndarray]) -> np.ndarray:
    """Return a node's new value at every point, the old one if no message is live."""
    old, links = values[node.key], network.incoming[node.key]
    if not links:
        return _emitted(network, node, np.zeros_like(old)) if network.rule == "always" else old
    sources = np.stack([values[link.source] for link in links])
    weights = np.array([link.weight for link in links])[:, None]
    live = ~np.isnan(sources) if network.rule == "live" else np.ones(sources.shape, bool)
    new = _emitted(network, node, AGGREGATIONS[node.aggregation](weights * sources, live))
    return np.where(live.any(0), new, old)


def _emitted(network: Network, node: Node, gathered: np.ndarray) -> np.ndarray:
    z = node.bias + node.response * gathered
    return np.clip(ACTIVATIONS[node.activation](z), -network.bound, network.bound)
