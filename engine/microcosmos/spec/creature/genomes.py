"""Genomes as they stand in creature files, by their encoding."""

from typing import Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from ...naming import decode
from .. import encodings, scene
from ..base import Part
from ..body import Body, shape
from ..control import Control, Sight
from ..encodings import MOST_GENES
from ..scene import Gait
from .cppn_genes import Connections, Nodes, check_genes


class CPPN(Part):
    """The genes of a controller, without unused room, in the order of their numbers."""

    encoding: Literal["cppn"]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    control: Control
    nodes: Nodes
    connections: Connections

    @model_validator(mode="after")
    def check(self) -> Self:
        _check_network(self, self.control)
        cycles = self.control.recurrent
        check_genes(len(self.inputs), len(self.outputs), self.nodes, self.connections, cycles)
        return self


class Grown(Part):
    """The genes of a network that grows a body and controls it."""

    encoding: Literal["cppn-body"]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    control: encodings.Grown
    nodes: Nodes
    connections: Connections

    @model_validator(mode="after")
    def check(self) -> Self:
        _check_network(self, self.control)
        check_genes(len(self.inputs), len(self.outputs), self.nodes, self.connections)
        return self


class Vector(Part):
    """Genes that are numbers from −1 to 1."""

    values: str = Field(max_length=8 * MOST_GENES)
    """Base64 of float32."""

    @field_validator("values")
    @classmethod
    def check_values(cls, text: str) -> str:
        if (largest := np.abs(decode(text)).max(initial=0)) > 1:
            raise ValueError(f"needs values from -1 to 1, got one of size {largest:g}")
        return text


class Direct(Vector):
    """The control of every joint and edge, and measures of the body."""

    encoding: Literal["direct"]
    control: encodings.Direct

    def refuse_other_length(self, body: Body) -> None:
        """There must be as many genes as the body needs."""
        _refuse_other_length(self.values, self.control, body)


class Weights(Vector):
    """The weights of a network of given layers."""

    encoding: Literal["weights"]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    control: encodings.Weights

    @model_validator(mode="after")
    def check(self) -> Self:
        _check_network(self, self.control)
        return self

    def refuse_other_length(self, body: Body) -> None:
        """There must be as many genes as the layers need."""
        _refuse_other_length(self.values, self.control, body)


class PluginGenome(Vector):
    """Numbers that a module of one's own makes movements of."""

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

    def refuse_other_length(self, body: Body) -> None:
        """There must be as many genes as the body needs."""
        _refuse_other_length(self.values, self.control, body)


class Fold(Part):
    """The rest angle of every joint and the rest length of every edge."""

    encoding: Literal["fold"]
    control: scene.Fold
    values: str = Field(max_length=8 * MOST_GENES)
    """Base64 of float32: rad that are added to the body's angles, then what
    `control.lengths` makes of its lengths."""

    def refuse_other_length(self, body: Body) -> None:
        """A number for each joint and edge."""
        whole = shape(body)
        needed, found = len(whole.joints) + len(whole.edges), len(decode(self.values))
        if found != needed:
            raise ValueError(f"`genome.values` must hold {needed} numbers, got {found}")


class Stroke(Gait):
    """A hand-made gait in the place of genes."""

    encoding: Literal["gait"]


Network = CPPN | Grown
"""Genomes whose genes are those of NEAT."""


def _check_network(genome: CPPN | Grown | Weights, control: Sight) -> None:
    """Inputs and outputs must be those that the controller has."""
    for name in ("inputs", "outputs"):
        needed, found = getattr(control, name), getattr(genome, name)
        if found != needed:
            raise ValueError(f"`{name}` must be {list(needed)}, got {list(found)}")


def _refuse_other_length(values: str, control: encodings.Controller, body: Body) -> None:
    needed, found = encodings.genes(control, shape(body)), len(decode(values))
    if found != needed:
        raise ValueError(f"`genome.values` must hold {needed} numbers, got {found}")
