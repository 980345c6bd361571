"""A CPPN that grows a chain and then sets its rest angles and rest lengths."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from ..world import State, World
from .control import drive_read, network_size
from .cppn import CPPN, evaluate, minimal
from .development import OUTPUTS, Controls, network_inputs
from .encoding import Drive, Scalar, shifted
from .genes import from_genes, to_genes
from .shaping import Plan, Shaped, cut, shaped, within

OF_JOINTS = ("rest_angle", "bend")
"""Measures that joints have; the others are of edges."""


@dataclass(frozen=True)
class Grown:
    """Body and controller by one network; outputs for the body are read at time 0."""

    controls: Controls
    room: tuple[int, int]
    bounds: Mapping[str, tuple[float, float]]
    """Of the body's free measures, in the order of the outputs behind the control's two."""
    least: int
    """Nodes that every body has."""
    plan: Plan

    @property
    def outputs(self) -> int:
        """Control, free measures, and growth."""
        return OUTPUTS + len(self.bounds) + 1

    def newcomer(self, *, key: PRNGKeyArray) -> CPPN:
        """Every input connected to every output."""
        return minimal(key, self.controls.inputs, self.outputs, *self.room)

    def drive(self, world: World, start: State, genotype: CPPN, phase: Scalar | None) -> Drive:
        """Open loop, or a closed one where the network senses."""
        body = self.grow(world, start, genotype)
        timer = shifted(self.controls.timer, phase)
        controls = replace(body.controls, timer=timer)

        def read(inputs):
            return evaluate(genotype, inputs, OUTPUTS)

        driven = drive_read(read, controls, body.world, body.start)
        return replace(driven, length=body.length)

    def grow(self, world: World, start: State, genotype: CPPN) -> Shaped:
        """The body that a network makes."""
        dtype = start.positions.dtype
        zero = jnp.zeros(len(self.controls.position), dtype) if self.controls.senses else None
        inputs = network_inputs(self.controls, jnp.zeros(len(self.controls.timer), dtype), zero)
        said = evaluate(genotype, inputs, self.outputs)[OUTPUTS:]
        traits = {
            name: within(jnp.tanh(self._of(name, values)), bounds)
            for (name, bounds), values in zip(self.bounds.items(), said[:-1], strict=True)
        }
        whole = shaped(world, start, self.controls, self.plan, traits)
        return cut(whole, self.present(said[-1]))

    def present(self, growth: Float[Array, "node"]) -> Bool[Array, "node"]:
        """The longest run of nodes from the first one where growth is above 0."""
        return (jnp.cumsum(growth <= 0) == 0) | (jnp.arange(len(growth)) < self.least)

    def size(self, genotype: CPPN) -> tuple[Array, Array]:
        """Hidden nodes and enabled connections."""
        return network_size(genotype, self.controls.inputs + self.outputs)

    def write(self, genotype: CPPN) -> dict[str, Any]:
        """Genes by their numbers."""
        return to_genes(genotype)

    def read(self, genes: Mapping[str, Any]) -> CPPN:
        """Genes in rows of this encoding's room."""
        return from_genes(genes, *self.room)

    def _of(self, name: str, values: Float[Array, "node"]) -> Float[Array, "item"]:
        """Of joints what their nodes have, of edges the mean of both ends."""
        if name in OF_JOINTS:
            return values[self.controls.joint_nodes]
        ends = self.controls.edges
        return 0.5 * (values[ends[:, 0]] + values[ends[:, 1]])
