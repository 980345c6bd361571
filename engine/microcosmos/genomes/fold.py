"""Folding: genes are constant rest angles and rest lengths."""

from collections.abc import Callable
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, PRNGKeyArray

from ..filaments import Rest
from ..world import State, World
from .encoding import Drive, Networkless, Scalar
from .genotype import Vector

Lengths = Callable[[Array, Array], Array]
"""A function from the body's rest lengths and genes to new rest lengths."""


def scaled(lengths: Array, genes: Array) -> Array:
    """Multiply by exponentials of genes; lengths stay positive."""
    return lengths * jnp.exp(genes)


def added(lengths: Array, genes: Array) -> Array:
    """Add genes in cells, as in the paper; lengths may become negative."""
    return lengths + genes


@dataclass(frozen=True)
class FoldEncoding(Networkless):
    """Genes of any size: changes of the body's rest angles, then of its rest lengths."""

    rest_angle: np.ndarray
    """(joint,) of the body, in rad."""
    rest_length: np.ndarray
    """(edge,) of the body, in cells."""
    steps: int
    lengths: Lengths = scaled

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        """Return the unchanged body; nothing is drawn."""
        return Vector(jnp.zeros(len(self.rest_angle) + len(self.rest_length)))

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        dtype, joints = start.positions.dtype, len(self.rest_angle)
        genes = genotype.values.astype(dtype)
        rest = Rest(
            jnp.asarray(self.rest_angle, dtype) + genes[:joints],
            self.lengths(jnp.asarray(self.rest_length, dtype), genes[joints:]),
        )
        return Drive(world, start, jnp.zeros((self.steps, 0), dtype), lambda *_: rest)
