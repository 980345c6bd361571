"""A CPPN that sets rest angles and rest lengths of a body that is given."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, PRNGKeyArray

from ..world import State, World, sense
from .cppn import CPPN, minimal
from .development import OUTPUTS, Controls, Read, reading, rest_shape, rest_shapes
from .encoding import Drive, Scalar, shifted
from .genes import from_genes, to_genes
from .recurrent import drive_recurrent


@dataclass(frozen=True)
class CPPNControl:
    """Controller alone: everybody has the same body."""

    controls: Controls
    room: tuple[int, int]
    recurrent: bool = False
    """Whether networks may have cycles; their nodes then keep values from step to step."""

    def newcomer(self, *, key: PRNGKeyArray) -> CPPN:
        """Every input connected to every output."""
        return minimal(key, self.controls.inputs, OUTPUTS, *self.room)

    def drive(self, world: World, start: State, genotype: CPPN, phase: Scalar | None) -> Drive:
        """Open loop, or a closed one where the network senses."""
        controls = replace(self.controls, timer=shifted(self.controls.timer, phase))
        if self.recurrent:
            return drive_recurrent(genotype, controls, world, start)
        return drive_read(reading(genotype), controls, world, start)

    def size(self, genotype: CPPN) -> tuple[Array, Array]:
        """Hidden nodes and enabled connections."""
        return network_size(genotype, self.controls.inputs + OUTPUTS)

    def write(self, genotype: CPPN) -> dict[str, Any]:
        """Genes by their numbers."""
        return to_genes(genotype)

    def read(self, genes: Mapping[str, Any]) -> CPPN:
        """Genes in rows of this encoding's room."""
        return from_genes(genes, *self.room)


def network_size(network: CPPN, fixed: int) -> tuple[Array, Array]:
    """Nodes beside the `fixed` inputs and outputs, and enabled connections."""
    enabled = network.connection_used & network.enabled
    return jnp.sum(network.node_used) - fixed, jnp.sum(enabled)


def drive_read(read: Read, controls: Controls, world: World, start: State) -> Drive:
    """A world under a network without memory."""
    dtype = start.positions.dtype
    if not controls.senses:
        return Drive(world, start, rest_shapes(read, controls, dtype))

    def control(world: World, state: State, given: tuple[Array, Array]):
        return rest_shape(read, controls, given[0], given[1], sense(world, state))

    inputs = jnp.asarray(controls.timer.T, dtype), jnp.asarray(controls.ramp, dtype)
    return Drive(world, start, inputs, control)
