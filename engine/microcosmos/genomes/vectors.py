"""Vectors of genes: newcomers, and how they stand in a creature file."""

from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import PRNGKeyArray

from ..naming import decode, encode
from .genotype import Vector


def evenly(genes: int, spread: float, *, key: PRNGKeyArray) -> Vector:
    """Genes within ± `spread`, each value equally likely."""
    return Vector(jax.random.uniform(key, (genes,), jnp.float32, -spread, spread))


def to_values(genotype: Vector) -> dict[str, Any]:
    """The genes of one vector of NumPy arrays."""
    return {"values": encode(np.asarray(genotype.values))}


def from_values(genes: Mapping[str, Any]) -> Vector:
    """The vector of a parsed creature file."""
    return jax.tree.map(np.array, Vector(jnp.asarray(decode(genes["values"]), jnp.float32)))
