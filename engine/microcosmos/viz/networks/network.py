"""Networks as data, in either of two conventions, and changes of their nodes."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isfinite
from typing import Literal

from .functions import ACTIVATIONS, AGGREGATIONS
from .graph import order

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
        """Keys in the order of the nodes."""
        return tuple(node.key for node in self.nodes)

    @cached_property
    def node(self) -> dict[int, Node]:
        """Nodes by key."""
        return {node.key: node for node in self.nodes}

    @cached_property
    def incoming(self) -> dict[int, list[Link]]:
        """Links by target, in the order of their sources' nodes."""
        row = {key: place for place, key in enumerate(self.keys)}
        found: dict[int, list[Link]] = {key: [] for key in self.keys}
        for link in sorted(self.links, key=lambda link: row[link.source]):
            found[link.target].append(link)
        return found

    @property
    def marked(self) -> bool:
        """Return whether the links have historical numbers."""
        return bool(self.links) and all(link.marker is not None for link in self.links)

    @cached_property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Source and target of every link."""
        return tuple((link.source, link.target) for link in self.links)

    @property
    def hidden(self) -> tuple[int, ...]:
        """Return the keys of nodes that are neither input nor output."""
        return tuple(k for k in self.keys if k >= self.inputs and k not in self.outputs)

    @property
    def names(self) -> dict[int, str]:
        """Names of inputs and outputs, by key."""
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
    keys = network.keys
    if len(set(keys)) < len(keys):
        raise ValueError(f"`keys` must differ, got {_first(_repeated(keys))} more than once")
    if wrong := [k for k in keys if not 0 <= k < 2**31]:
        raise ValueError(f"`keys` must be from 0 to 2³¹ − 1, got {_first(wrong)}")
    if network.inputs < 1 or not network.outputs:
        raise ValueError("`inputs` and `outputs` must be at least one each, got none")
    if (
        len(set(network.outputs)) < len(network.outputs)
        or min(network.outputs) < network.inputs
    ):
        raise ValueError(
            f"`outputs` must differ from inputs and each other, got {_first(network.outputs)}"
        )
    if missing := {*range(network.inputs), *network.outputs} - set(keys):
        raise ValueError(f"`keys` must hold all inputs and outputs, misses {_first(missing)}")
    _finite("bias", [node.bias for node in network.nodes])
    _finite("response", [node.response for node in network.nodes])
    for field, names, needed in (
        ("input_names", network.input_names, network.inputs),
        ("output_names", network.output_names, len(network.outputs)),
    ):
        if names and len(names) != needed:
            raise ValueError(f"`{field}` must be none or {needed}, got {len(names)}")


def _check_functions(network: Network) -> None:
    if wrong := {node.activation for node in network.nodes} - set(ACTIVATIONS):
        raise ValueError(f"`activation` must be among {list(ACTIVATIONS)}, got {_first(wrong)}")
    if wrong := {node.aggregation for node in network.nodes} - set(AGGREGATIONS):
        raise ValueError(
            f"`aggregation` must be among {list(AGGREGATIONS)}, got {_first(wrong)}"
        )
    if network.output_transform not in (None, *ACTIVATIONS):
        raise ValueError(
            f"`output_transform` must be none or among {list(ACTIVATIONS)}, "
            f"got {network.output_transform!r}"
        )


def _check_links(network: Network) -> None:
    markers = [link.marker for link in network.links if link.marker is not None]
    if len(set(markers)) < len(markers):
        raise ValueError(f"`marker` must differ, got {_first(_repeated(markers))} twice")
    targets = [link.target for link in network.links]
    if missing := {*targets, *(link.source for link in network.links)} - set(network.keys):
        raise ValueError(f"connections must join existing nodes, got {_first(missing)}")
    if wrong := [target for target in targets if target < network.inputs]:
        raise ValueError(f"`target` must not be an input, got {_first(wrong)}")
    if len(set(network.pairs)) < len(network.pairs):
        twice = _first(_repeated(network.pairs))
        raise ValueError(f"connections must join a pair of nodes once, got twice {twice}")
    _finite("weight", [link.weight for link in network.links])


def _finite(field: str, values: list[float]) -> None:
    if wrong := [value for value in values if not isfinite(value)]:
        raise ValueError(f"`{field}` must be finite, got {_first(wrong)}")


def _repeated(items) -> list:
    return sorted(item for item in set(items) if list(items).count(item) > 1)


def _first(items) -> str:
    return ", ".join(str(item) for item in sorted(items)[:5])
