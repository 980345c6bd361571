"""A network as data, in whichever of two conventions it is meant."""

from dataclasses import dataclass
from math import inf, isfinite
from typing import Literal

from .functions import ACTIVATIONS, AGGREGATIONS
from .graph import order

LARGEST_KEY = 2**24
"""TensorNEAT keeps keys as float32, exact only below this."""


@dataclass(frozen=True)
class Network:
    """Nodes by key, the inputs 0, 1, … among them, and connections between keys.

    A node computes z = bias + response × aggregation(weight × value of each source), and its
    value is activation(z) kept within ±`bound`. Where the rule is `live` (TensorNEAT's), a
    message counts only if its source has a value, and a node without one has none: NaN.
    Where it is `always` (ours), a node without sources computes activation(bias).

    Feed-forward, or `steps` times computed all at once from the values before (recurrent).
    """

    inputs: int
    outputs: tuple[int, ...]
    keys: tuple[int, ...]
    bias: tuple[float, ...]
    response: tuple[float, ...]
    aggregation: tuple[str, ...]
    activation: tuple[str, ...]
    source: tuple[int, ...]
    target: tuple[int, ...]
    weight: tuple[float, ...]
    marker: tuple[int, ...] | None = None
    """Historical numbers of the connections, where they have any."""
    rule: Literal["live", "always"] = "live"
    steps: int | None = None
    output_transform: str | None = None
    """An activation that is applied to every output at the end, unseen by other nodes."""
    bound: float = inf
    input_names: tuple[str, ...] = ()
    output_names: tuple[str, ...] = ()

    def __post_init__(self):
        _check_nodes(self)
        _check_functions(self)
        _check_connections(self)
        if self.rule not in ("live", "always"):
            raise ValueError(f"`rule` must be live or always, got {self.rule!r}")
        if self.steps is None:
            order(self.keys, self.pairs)
        elif self.steps < 1:
            raise ValueError(f"`steps` must be at least 1, got {self.steps}")

    @property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Source and target of every connection."""
        return tuple(zip(self.source, self.target, strict=True))

    @property
    def hidden(self) -> tuple[int, ...]:
        """The keys of nodes that are neither input nor output."""
        return tuple(k for k in self.keys if k >= self.inputs and k not in self.outputs)

    @property
    def names(self) -> dict[int, str]:
        """What inputs and outputs are called, by key."""
        inputs = self.input_names or tuple(f"input {i}" for i in range(self.inputs))
        outputs = self.output_names or tuple(f"output {i}" for i in range(len(self.outputs)))
        return dict(enumerate(inputs)) | dict(zip(self.outputs, outputs, strict=True))


def _check_nodes(network: Network) -> None:
    keys = network.keys
    columns = (network.bias, network.response, network.aggregation, network.activation)
    _same_length("keys", keys, *columns)
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
    _finite("bias", network.bias)
    _finite("response", network.response)
    for field, names, needed in (
        ("input_names", network.input_names, network.inputs),
        ("output_names", network.output_names, len(network.outputs)),
    ):
        if names and len(names) != needed:
            raise ValueError(f"`{field}` must be none or {needed}, got {len(names)}")


def _check_functions(network: Network) -> None:
    if wrong := set(network.activation) - set(ACTIVATIONS):
        raise ValueError(f"`activation` must be among {list(ACTIVATIONS)}, got {_first(wrong)}")
    if wrong := set(network.aggregation) - set(AGGREGATIONS):
        raise ValueError(
            f"`aggregation` must be among {list(AGGREGATIONS)}, got {_first(wrong)}"
        )
    if network.output_transform not in (None, *ACTIVATIONS):
        raise ValueError(
            f"`output_transform` must be none or among {list(ACTIVATIONS)}, "
            f"got {network.output_transform!r}"
        )


def _check_connections(network: Network) -> None:
    _same_length("source", network.source, network.target, network.weight)
    if network.marker is not None:
        _same_length("marker", network.marker, network.source)
        if len(set(network.marker)) < len(network.marker):
            raise ValueError(
                f"`marker` must differ, got {_first(_repeated(network.marker))} twice"
            )
    if missing := {*network.source, *network.target} - set(network.keys):
        raise ValueError(f"connections must join existing nodes, got {_first(missing)}")
    if wrong := [target for target in network.target if target < network.inputs]:
        raise ValueError(f"`target` must not be an input, got {_first(wrong)}")
    if len(set(network.pairs)) < len(network.pairs):
        twice = _first(_repeated(network.pairs))
        raise ValueError(f"connections must join a pair of nodes once, got twice {twice}")
    _finite("weight", network.weight)


def _finite(field: str, values: tuple[float, ...]) -> None:
    if wrong := [value for value in values if not isfinite(value)]:
        raise ValueError(f"`{field}` must be finite, got {_first(wrong)}")


def _same_length(field: str, *columns) -> None:
    if len({len(column) for column in columns}) > 1:
        lengths = [len(column) for column in columns]
        raise ValueError(f"`{field}` and its columns must be of one length, got {lengths}")


def _repeated(items) -> list:
    return sorted(item for item in set(items) if list(items).count(item) > 1)


def _first(items) -> str:
    return ", ".join(str(item) for item in sorted(items)[:5])
