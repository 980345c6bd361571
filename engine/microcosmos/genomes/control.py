"""A CPPN that sets rest angles and rest lengths of a body that is given."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, PRNGKeyArray

from ..world import State, World, sense
from .cppn import CPPN, minimal
from .development import OUTPUTS, Controls, develop, respond
from .encoding import Drive, Scalar, shifted
from .genes import from_genes, to_genes


@dataclass(frozen=True)
class CPPNControl:
    """Controller alone: everybody has the same body."""

    controls: Controls
    room: tuple[int, int]

    def newcomer(self, *, key: PRNGKeyArray) -> CPPN:
        """Every input connected to every output."""
        return minimal(key, self.controls.inputs, OUTPUTS, *self.room)

    def drive(self, world: World, start: State, genotype: CPPN, phase: Scalar | None) -> Drive:
        """Open loop, or a closed one where the network senses."""
        controls = replace(self.controls, timer=shifted(self.controls.timer, phase))
        if not controls.senses:
            return Drive(world, start, develop(genotype, controls))

        def control(world: World, state: State, given: tuple[Array, Array]):
            return respond(genotype, controls, given[0], given[1], sense(world, state))

        dtype = genotype.bias.dtype
        inputs = jnp.asarray(controls.timer.T, dtype), jnp.asarray(controls.ramp, dtype)
        return Drive(world, start, inputs, control)

    def size(self, genotype: CPPN) -> tuple[Array, Array]:
        """Hidden nodes and enabled connections."""
        fixed = self.controls.inputs + OUTPUTS
        enabled = genotype.connection_used & genotype.enabled
        return jnp.sum(genotype.node_used) - fixed, jnp.sum(enabled)

    def write(self, genotype: CPPN) -> dict[str, Any]:
        """Genes by their numbers."""
        return to_genes(genotype)

    def read(self, genes: Mapping[str, Any]) -> CPPN:
        """Genes in rows of this encoding's room."""
        return from_genes(genes, *self.room)
