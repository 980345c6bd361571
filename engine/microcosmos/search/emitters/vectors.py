"""Variation of vectors: isotropic steps, and steps along the line between elites."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ...genomes import Vector
from ..insertion import Elites
from .elites import Newcomer, children, newcomers
from .emitter import Children, Keys, Stateless
from .selection import Select, draw


@dataclass(frozen=True)
class IsoLine(Stateless):
    """x + σ₁ N(0, I) + σ₂ (y − x) N(0, 1): Vassiliades and Mouret, GECCO 2018, eq. 3.

    Parents are elites. Genes stay within −1 and 1. Without a line it is a Gaussian mutation.
    """

    slots: int
    newcomer: Newcomer
    iso: float
    line: float = 0.0
    select: Select = "uniform"

    def emit(self, state: None, archive: Elites, *, keys: Keys) -> tuple[Children, None, None]:
        def varied() -> Children:
            values, *cells = jax.vmap(lambda key: self._child(archive, key=key))(keys)
            parents, name = (cells, "iso+line") if self.line else (cells[:1], "gaussian")
            return children(Vector(values), parents, name)

        fresh = partial(newcomers, self.newcomer, keys)
        return jax.lax.cond(jnp.any(archive.occupied), varied, fresh), None, None

    def _child(
        self, archive: Elites, *, key: PRNGKeyArray
    ) -> tuple[Float[Array, "gene"], Int[Array, ""], Int[Array, ""]]:
        one_key, other_key, iso_key, line_key = jax.random.split(key, 4)
        genes = archive.genotypes
        assert isinstance(genes, Vector)
        one, other = (draw(archive, self.select, key=key) for key in (one_key, other_key))
        x, y = genes.values[one], genes.values[other]
        step = self.iso * jax.random.normal(iso_key, x.shape, x.dtype)
        along = self.line * jax.random.normal(line_key, (), x.dtype)
        return jnp.clip(x + step + along * (y - x), -1.0, 1.0), one, other
