"""Genomes in creature files, by their encoding."""

from typing import Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from ...naming import decode
from .. import encodings, scene
from ..base import Part
from ..body import Body, shape
from ..control import Control, NetworkInputs
from ..encodings import MAX_GENES
from ..scene import Gait
from .cppn_genes import Connections, Nodes, check_genes


class Network(Part):
    """The used NEAT genes of a network, ordered by number."""

    encoding: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    control: Control | encodings.Grown
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
