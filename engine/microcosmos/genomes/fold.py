"""Folding: genes are the rest angle of every joint and the rest length of every edge."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, PRNGKeyArray

from ..filaments import Rest
from ..world import State, World
from .encoding import Drive, Scalar, none
from .genotype import Vector
from .vectors import from_values, to_values

Lengths = Callable[[Array, Array], Array]
"""From the body's own rest lengths and genes to rest lengths."""


def scaled(own: Array, genes: Array) -> Array:
    """Genes are logarithms of factors: lengths stay positive."""
    return own * jnp.exp(genes)


def added(own: Array, genes: Array) -> Array:
    """Genes are cells, as in the paper; nothing keeps lengths positive."""
    return own + genes


@dataclass(frozen=True)
class Fold:
    """Numbers of any size: angles added to the body's own, then lengths; both stay for life."""

    rest_angle: np.ndarray
    """(joint,) of the body, in rad."""
    rest_length: np.ndarray
    """(edge,) of the body, in cells."""
    steps: int
    lengths: Lengths = scaled

    @property
    def room(self) -> None:
        """There is no network."""
        return None

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        """The body as it is: nothing is drawn."""
        return Vector(jnp.zeros(len(self.rest_angle) + len(self.rest_length)))

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        """The same rest shape at all times."""
        dtype, joints = start.positions.dtype, len(self.rest_angle)
        genes = genotype.values.astype(dtype)
        rest = Rest(
            jnp.asarray(self.rest_angle, dtype) + genes[:joints],
            self.lengths(jnp.asarray(self.rest_length, dtype), genes[joints:]),
        )
        return Drive(world, start, jnp.zeros((self.steps, 0), dtype), lambda *_: rest)

    def size(self, genotype: Vector) -> tuple[Array, Array]:
        """No network."""
        return none()

    def write(self, genotype: Vector) -> dict[str, Any]:
        """All genes."""
        return to_values(genotype)

    def read(self, genes: Mapping[str, Any]) -> Vector:
        """All genes."""
        return from_values(genes)
