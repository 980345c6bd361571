"""Where children come from: mutated elites, or new random networks."""

from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, PRNGKeyArray

from .. import neat
from ..genomes import CPPN
from .insertion import Elites

OPERATORS = ("random", "neat")
"""How a child arose, by operator code."""

NO_PARENT = -1


class Children(eqx.Module):
    """A generation to be evaluated; `parent` is a cell of the archive or −1."""

    networks: CPPN
    parent: Int[Array, "slot"]
    operator: Int[Array, "slot"]


@dataclass(frozen=True)
class Genes:
    """The sizes of networks and the rates at which they vary."""

    inputs: int
    outputs: int
    max_nodes: int
    max_connections: int
    rates: neat.Rates


def vary(
    archive: Elites,
    counters: neat.Counters,
    generation: Int[Array, ""],
    genes: Genes,
    *,
    key: PRNGKeyArray,
    batch: int,
) -> tuple[Children, neat.Counters]:
    """Children of elites drawn with equal probability; random ones where there are none.

    Every slot has a key of its own, derived from the seed, the generation and the slot.
    """
    keys = jax.vmap(lambda slot: jax.random.fold_in(jax.random.fold_in(key, generation), slot))(
        jnp.arange(batch)
    )
    total = jnp.sum(archive.occupied)

    def child(key):
        select_key, mutate_key = jax.random.split(key)
        rank = jax.random.randint(select_key, (), 0, jnp.maximum(1, total))
        cell = jnp.argmax(jnp.cumsum(archive.occupied) > rank)
        parent = jax.tree.map(lambda x: x[cell], archive.networks)
        network, novelty = neat.mutate(parent, genes.rates, genes.inputs, key=mutate_key)
        return network, novelty, cell

    networks, novelty, cell = jax.vmap(child)(keys)
    networks, numbered = neat.number(networks, novelty, counters)
    fresh = newcomers(generation, genes, key=key, batch=batch)
    varied = Children(networks, cell, jnp.ones(batch, jnp.int32)), numbered
    return jax.tree.map(
        lambda one, other: jnp.where(total > 0, one, other), varied, (fresh, counters)
    )


def newcomers(
    generation: Int[Array, ""], genes: Genes, *, key: PRNGKeyArray, batch: int
) -> Children:
    """Random minimal networks, a key for each slot."""

    def create(slot):
        own = jax.random.fold_in(jax.random.fold_in(key, generation), slot)
        return neat.minimal(
            own, genes.inputs, genes.outputs, genes.max_nodes, genes.max_connections
        )

    networks = jax.vmap(create)(jnp.arange(batch))
    return Children(
        networks, jnp.full(batch, NO_PARENT, jnp.int32), jnp.zeros(batch, jnp.int32)
    )
