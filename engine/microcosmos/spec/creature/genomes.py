"""Genomes in creature files, by their encoding."""

from typing import Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from ... import bodies
from ...bodies import growth
from ...naming import decode, decoded
from .. import encodings, scene
from ..base import Part
from ..body import Body, GrownBody, shape
from ..control import Control, NetworkInputs
from ..encodings import MAX_GENES
from ..scene import Gait
from .cppn_genes import Connections, Float32, Nodes, Number, check_genes

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
    control: Control | encodings.Grown | encodings.BodyGraph
    nodes: Nodes
    connections: Connections

    @model_validator(mode="after")
    def check(self) -> Self:
        _check_ends(self, self.control)
        cycles = getattr(self.control, "recurrent", False)
        check_genes(len(self.inputs), len(self.outputs), self.nodes, self.connections, cycles)
        return self


class CPPN(Network):
    """The genes of a CPPN controller."""

    encoding: Literal["cppn"]
    control: Control


class Grown(Network):
    """The genes of a CPPN that grows a body and controls it."""

    encoding: Literal["cppn-body"]
    control: encodings.Grown


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
        if len(set(lengths.values())) > 1:
            raise ValueError(f"`plan` must have columns of one length, got {lengths}")
        if len(set(self.number)) < len(self.number):
            raise ValueError(f"`plan.number` must differ, got {list(self.number)}")
        for row, parent in enumerate(self.parent):
            if parent >= max(row, 1):
                raise ValueError(
                    f"`plan.parent` must be an earlier row, got {parent} in row {row}"
                )
        for name, low, high in SHAPE_LIMITS:
            for value in numbers[name]:
                if not low <= value <= high:
                    raise ValueError(
                        f"`plan.{name}` must be from {low:g} to {high:g}, got {value:g}"
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
                    raise ValueError(f"`plan.{name}` must be 1 to {limit}, got {value}")
        if len(self.number) > body.segments:
            raise ValueError(
                f"`plan` must have at most {body.segments} segments, got {len(self.number)}"
            )


class BodyGraph(Network):
    """The genes of a body plan, and of the network that drives the body."""

    encoding: Literal["body-graph"]
    control: encodings.BodyGraph
    plan: Segments


class Vector(Part):
    """Genes that are numbers from −1 to 1."""

    control: encodings.Direct | encodings.Weights | encodings.PluginControl
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


class Weights(Vector):
    """The weights of a network with fixed layers."""

    encoding: Literal["weights"]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    control: encodings.Weights

    @model_validator(mode="after")
    def check(self) -> Self:
        _check_ends(self, self.control)
        return self


class PluginGenome(Vector):
    """Numbers that a plug-in turns into movements."""

    encoding: str
    control: encodings.PluginControl

    @model_validator(mode="after")
    def check(self) -> Self:
        if self.encoding != self.control.encoding:
            raise ValueError(
                f"`encoding` must be {self.control.encoding!r} as `control` has it, got "
                f"{self.encoding!r}"
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


def _check_ends(genome: Network | Weights, control: NetworkInputs) -> None:
    for name in ("inputs", "outputs"):
        needed, found = getattr(control, name), getattr(genome, name)
        if found != needed:
            raise ValueError(f"`{name}` must be {list(needed)}, got {list(found)}")


def _refuse_count(values: str, needed: int) -> None:
    if (found := len(decode(values))) != needed:
        raise ValueError(f"`genome.values` must hold {needed} numbers, got {found}")
