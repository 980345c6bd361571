"""Genomes in creature files, by their encoding, and the validation of NEAT genes."""

from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, field_validator, model_validator

from ... import bodies
from ...bodies import growth
from ...invalid import InvalidField
from ...naming import decode, decoded
from .. import encodings, scene
from ..base import Numeric, Part, refuse
from ..body import Body, GrownBody, shape
from ..control import Control
from ..encodings import MAX_GENES
from ..scene import Gait

Activation = Literal[
    "identity", "sigmoid", "tanh", "relu", "sin", "cos", "gaussian", "abs", "square"
]

MAX_NODES, MAX_CONNECTIONS = 1024, 8192


Number = Annotated[int, Field(ge=0, lt=2**31), Numeric]


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
    refuse(
        nodes.id[:fixed] != tuple(range(fixed)),
        "nodes.id",
        f"must begin with 0 to {fixed - 1}, got {nodes.id[:fixed]}",
    )
    if set(nodes.activation[:inputs]) != {"identity"} or decode(nodes.bias)[:inputs].any():
        needed = "activation identity and bias 0"
        raise InvalidField("nodes", f"must have {needed} where they are inputs")
    pairs = list(zip(connections.source, connections.target, strict=True))
    refuse(
        len(set(pairs)) < len(pairs), "connections", "must join each pair of nodes at most once"
    )
    if missing := set(connections.source + connections.target) - set(nodes.id):
        raise InvalidField(
            "connections", f"must join existing nodes, got {sorted(missing)[:5]}"
        )
    refuse(
        any(target < inputs for target in connections.target),
        "connections.target",
        "must not be an input",
    )
    if not cycles:
        _refuse_cycles(pairs)


def _same_length(where: str, *columns) -> None:
    lengths = [len(column) for column in columns]
    refuse(len(set(lengths)) > 1, where, f"must have columns of one length, got {lengths}")


def _increasing(where: str, numbers: tuple[int, ...]) -> None:
    refuse(any(a >= b for a, b in pairwise(numbers)), where, "must increase strictly")


def _refuse_cycles(pairs: list[tuple[int, int]]) -> None:
    sorter = TopologicalSorter()
    for source, target in pairs:
        sorter.add(target, source)
    try:
        sorter.prepare()
    except CycleError as error:
        raise InvalidField("connections", "must be free of cycles") from error


MAX_SEGMENTS = 32
SHAPE_LIMITS = (
    ("place", 0.0, 1.0),
    ("angle", -3.2, 3.2),
    ("curl", -6.3, 6.3),
    ("stiffness", 0.0, 1.0),
)
"""Genes of segments that are numbers, and their ends."""


class Network(Part):
    """The used NEAT genes of a network, ordered by number."""

    encoding: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    control: Control | encodings.BodyGraph
    nodes: Nodes
    connections: Connections

    @model_validator(mode="after")
    def check(self) -> Self:
        for name in ("inputs", "outputs"):
            needed, found = getattr(self.control, name), getattr(self, name)
            refuse(found != needed, name, f"must be {list(needed)}, got {list(found)}")
        cycles = getattr(self.control, "recurrent", False)
        check_genes(len(self.inputs), len(self.outputs), self.nodes, self.connections, cycles)
        return self


class CPPN(Network):
    """The genes of a CPPN controller."""

    encoding: Literal["cppn"]
    control: Control


class Segments(Part):
    """Genes of a body plan, in order; each segment stands behind the one it is attached to."""

    number: tuple[Number, ...] = Field(min_length=1, max_length=MAX_SEGMENTS)
    parent: tuple[Number, ...] = Field(max_length=MAX_SEGMENTS)
    place: Float32 = Field(max_length=8 * MAX_SEGMENTS)
    angle: Float32 = Field(max_length=8 * MAX_SEGMENTS)
    nodes: tuple[Number, ...] = Field(max_length=MAX_SEGMENTS)
    curl: Float32 = Field(max_length=8 * MAX_SEGMENTS)
    stiffness: Float32 = Field(max_length=8 * MAX_SEGMENTS)
    mirrored: tuple[bool, ...] = Field(max_length=MAX_SEGMENTS)
    copies: tuple[Number, ...] = Field(max_length=MAX_SEGMENTS)
    closed: tuple[bool, ...] = Field(max_length=MAX_SEGMENTS)

    @model_validator(mode="after")
    def check(self) -> Self:
        numbers = {name: decode(getattr(self, name)) for name, *_ in SHAPE_LIMITS}
        columns = {name: getattr(self, name) for name in type(self).model_fields} | numbers
        lengths = {name: len(column) for name, column in columns.items()}
        refuse(
            len(set(lengths.values())) > 1,
            "plan",
            f"must have columns of one length, got {lengths}",
        )
        refuse(
            len(set(self.number)) < len(self.number),
            "plan.number",
            f"must differ, got {list(self.number)}",
        )
        for row, parent in enumerate(self.parent):
            if parent >= max(row, 1):
                raise InvalidField(
                    "plan.parent", f"must be an earlier row, got {parent} in row {row}"
                )
        for name, low, high in SHAPE_LIMITS:
            for value in numbers[name]:
                if not low <= value <= high:
                    raise InvalidField(
                        f"plan.{name}", f"must be from {low:g} to {high:g}, got {value:g}"
                    )
        return self

    def grow(self, body: GrownBody, softest: float) -> bodies.Body:
        """Return the body that the plan grows into, in the sizes of `body`."""
        columns = {name: getattr(self, name) for name in type(self).model_fields}
        plan = growth.plan_of(decoded(columns), body.segments)
        return growth.grown_body(plan, body.capacity, softest)

    def refuse_unfit(self, body: GrownBody) -> None:
        """Raise `ValueError` where a plan has more than its body allows."""
        most = {"nodes": body.segment_nodes, "copies": body.copies}
        for name, limit in most.items():
            for value in getattr(self, name):
                if not 1 <= value <= limit:
                    raise InvalidField(f"plan.{name}", f"must be 1 to {limit}, got {value}")
        refuse(
            len(self.number) > body.segments,
            "plan",
            f"must have at most {body.segments} segments, got {len(self.number)}",
        )


class BodyGraph(Network):
    """The genes of a body plan, and of the network that drives the body."""

    encoding: Literal["body-graph"]
    control: encodings.BodyGraph
    plan: Segments


class Vector(Part):
    """Genes that are numbers from −1 to 1."""

    control: encodings.Direct | encodings.PluginControl
    values: str = Field(max_length=8 * MAX_GENES)
    """Base64 of float32."""

    @field_validator("values")
    @classmethod
    def check_values(cls, text: str) -> str:
        if (largest := np.abs(decode(text)).max(initial=0)) > 1:
            raise ValueError(f"needs values from -1 to 1, got one of size {largest:g}")
        return text

    def refuse_other_length(self, body: Body) -> None:
        """Raise `ValueError` where the body needs another number of genes."""
        _refuse_count(self.values, encodings.gene_count(self.control, shape(body)))


class Direct(Vector):
    """The control of every joint and edge, and inherited traits of the body."""

    encoding: Literal["direct"]
    control: encodings.Direct


class PluginGenome(Vector):
    """Numbers that a plug-in turns into movements."""

    encoding: str
    control: encodings.PluginControl

    @model_validator(mode="after")
    def check(self) -> Self:
        refuse(
            self.encoding != self.control.encoding,
            "encoding",
            f"must be {self.control.encoding!r} as `control` has it, got {self.encoding!r}",
        )
        return self


class Fold(Part):
    """A constant rest angle of every joint and rest length of every edge."""

    encoding: Literal["fold"]
    control: scene.Fold
    values: str = Field(max_length=8 * MAX_GENES)
    """Base64 of float32: rad added to the body's angles, then changes of its lengths as
    `control.lengths` says."""

    def refuse_other_length(self, body: Body) -> None:
        graph = shape(body)
        _refuse_count(self.values, len(graph.joints) + len(graph.edges))


class GaitGenome(Gait):
    """A hand-made gait in place of genes."""

    encoding: Literal["gait"]


def _refuse_count(values: str, needed: int) -> None:
    if (found := len(decode(values))) != needed:
        raise InvalidField("genome.values", f"must hold {needed} numbers, got {found}")
