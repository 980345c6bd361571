"""NEAT genes of a CPPN in a creature file, and their validation."""

from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from ...naming import decode
from ..base import Part

Activation = Literal[
    "identity", "sigmoid", "tanh", "relu", "sin", "cos", "gaussian", "abs", "square"
]

MAX_NODES, MAX_CONNECTIONS = 1024, 8192

Number = Annotated[int, Field(ge=0, lt=2**31)]


def _decodable(text: str) -> str:
    decode(text)
    return text


Float32 = Annotated[str, AfterValidator(_decodable)]
"""Base64 of float32 values."""


class Nodes(Part):
    """Node genes: numbers, activations and biases."""

    id: tuple[Number, ...] = Field(max_length=MAX_NODES)
    activation: tuple[Activation, ...] = Field(max_length=MAX_NODES)
    bias: Float32 = Field(max_length=8 * MAX_NODES)


class Connections(Part):
    """Connection genes: innovation numbers, ends by node number, flags and weights."""

    innovation: tuple[Number, ...] = Field(max_length=MAX_CONNECTIONS)
    source: tuple[Number, ...] = Field(max_length=MAX_CONNECTIONS)
    target: tuple[Number, ...] = Field(max_length=MAX_CONNECTIONS)
    enabled: tuple[bool, ...] = Field(max_length=MAX_CONNECTIONS)
    weight: Float32 = Field(max_length=8 * MAX_CONNECTIONS)


def check_genes(
    inputs: int, outputs: int, nodes: Nodes, connections: Connections, cycles: bool = False
) -> None:
    """Raise `ValueError` where genes do not make a network in canonical order.

    The network must be feed-forward unless `cycles` are allowed.
    """
    _same_length("nodes", nodes.id, nodes.activation, decode(nodes.bias))
    _same_length(
        "connections",
        connections.innovation,
        connections.source,
        connections.target,
        connections.enabled,
        decode(connections.weight),
    )
    _increasing("nodes.id", nodes.id)
    _increasing("connections.innovation", connections.innovation)
    fixed = inputs + outputs
    if nodes.id[:fixed] != tuple(range(fixed)):
        raise ValueError(f"`nodes.id` must begin with 0 to {fixed - 1}, got {nodes.id[:fixed]}")
    if set(nodes.activation[:inputs]) != {"identity"} or decode(nodes.bias)[:inputs].any():
        raise ValueError("`nodes` that are inputs must have activation identity and bias 0")
    pairs = list(zip(connections.source, connections.target, strict=True))
    if len(set(pairs)) < len(pairs):
        raise ValueError("`connections` must join each pair of nodes at most once")
    if missing := set(connections.source + connections.target) - set(nodes.id):
        raise ValueError(f"`connections` must join existing nodes, got {sorted(missing)[:5]}")
    if any(target < inputs for target in connections.target):
        raise ValueError("`connections.target` must not be an input")
    if not cycles:
        _refuse_cycles(pairs)


def _same_length(where: str, *columns) -> None:
    lengths = [len(column) for column in columns]
    if len(set(lengths)) > 1:
        raise ValueError(f"`{where}` must have columns of one length, got {lengths}")


def _increasing(where: str, numbers: tuple[int, ...]) -> None:
    if any(a >= b for a, b in pairwise(numbers)):
        raise ValueError(f"`{where}` must increase strictly")


def _refuse_cycles(pairs: list[tuple[int, int]]) -> None:
    sorter = TopologicalSorter()
    for source, target in pairs:
        sorter.add(target, source)
    try:
        sorter.prepare()
    except CycleError as error:
        raise ValueError("`connections` must be free of cycles") from error
