"""Emitters that are told derivatives of fitness and descriptors before their children live."""

from typing import Protocol, runtime_checkable

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from ...genomes import Genotype
from .emitter import Children, Emitter, Kept


class Slopes(eqx.Module):
    """Derivatives by genes: of fitness first, then of every descriptor."""

    rows: Float[Array, "*block output gene"]
    sound: Bool[Array, "*block"]
    """Whether the simulation stayed finite, and all derivatives."""


@runtime_checkable
class Learner(Emitter, Protocol):
    """An emitter whose children are changed, `lessons` times, by derivatives it asks for."""

    @property
    def lessons(self) -> int:
        """How often in a generation."""
        ...

    def asks(self, state: Kept, children: Children) -> Genotype:
        """Genotypes, their number first, of which derivatives are wanted."""
        ...

    def learn(self, state: Kept, children: Children, slopes: Slopes) -> tuple[Children, Kept]:
        """The children, and the state, after a lesson."""
        ...


def unit(rows: Float[Array, "*block gene"]) -> Float[Array, "*block gene"]:
    """Rows of length 1; those of length 0 stay."""
    length = jnp.sqrt(jnp.sum(rows * rows, -1, keepdims=True) + 1e-30)
    return rows / length
