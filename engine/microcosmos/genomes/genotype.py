"""What is inherited: networks of genes, or plain vectors of numbers."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, UInt32

from .cppn import CPPN


class Vector(eqx.Module):
    """Genes that are numbers from −1 to 1; what each means is for an encoding to say."""

    values: Float[Array, "*batch gene"]


Genotype = CPPN | Vector


def words(genotypes: Genotype) -> UInt32[Array, "row word"]:
    """Every gene of a batch as 32 bits, −0 counting as 0."""
    if isinstance(genotypes, Vector):
        return _bits(genotypes.values)
    columns = [
        genotypes.node_id,
        genotypes.activation,
        _bits(genotypes.bias),
        genotypes.innovation,
        genotypes.source,
        genotypes.target,
        genotypes.enabled,
        _bits(genotypes.weight),
    ]
    return jnp.concatenate([column.astype(jnp.uint32) for column in columns], 1)


def _bits(values: Float[Array, "row gene"]) -> UInt32[Array, "row gene"]:
    return jax.lax.bitcast_convert_type(values.astype(jnp.float32) + 0.0, jnp.uint32)
