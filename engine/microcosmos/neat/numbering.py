"""Numbering of new genes: equal mutations in a generation get equal numbers."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from ..genomes import CPPN
from .mutation import Novelty
from .rows import NONE


class Counters(eqx.Module):
    """The next unused numbers."""

    innovation: Int[Array, ""]
    node: Int[Array, ""]


def first_counters(inputs: int, outputs: int) -> Counters:
    """Return the counters after the genes of minimal networks."""
    # Strong types: weak ones would compile programs anew.
    return Counters(jnp.asarray(inputs * outputs, int), jnp.asarray(inputs + outputs, int))


def number(children: CPPN, novelty: Novelty, counters: Counters) -> tuple[CPPN, Counters]:
    """Number the new genes of a batch; added connections come before split ones."""
    take = jax.vmap(lambda values, row: values[row])

    def ends(rows):
        numbers = take(children.node_id, take(rows, novelty.connection_row))
        return jnp.where(novelty.connection_row < 0, NONE, numbers)

    added, many_added = ranks(ends(children.source), ends(children.target))
    split, many_split = ranks(novelty.split_innovation, novelty.split_innovation)
    node = counters.node + split
    first = counters.innovation + many_added + 2 * split
    innovation = _assign(
        children.innovation, novelty.connection_row, counters.innovation + added
    )
    innovation = _assign(innovation, novelty.split_row, first)
    second = jnp.where(novelty.split_row < 0, NONE, novelty.split_row + 1)
    innovation = _assign(innovation, second, first + 1)
    node_id = _assign(children.node_id, novelty.node_row, node)
    children = replace(children, innovation=innovation, node_id=node_id)
    return children, Counters(
        counters.innovation + many_added + 2 * many_split, counters.node + many_split
    )


def ranks(
    first: Int[Array, "child"], second: Int[Array, "child"]
) -> tuple[Int[Array, "child"], Int[Array, ""]]:
    """Return each child's rank among the distinct pairs, and their number.

    A negative `first` means no pair.
    """
    order = jnp.lexsort((second, first))
    a, b = first[order], second[order]
    changed = (a != jnp.roll(a, 1)) | (b != jnp.roll(b, 1))
    changed = changed.at[0].set(True) & (a >= 0)
    place = jnp.cumsum(changed) - 1
    return jnp.zeros_like(first).at[order].set(jnp.maximum(place, 0)), jnp.sum(changed)


def _assign(values: Int[Array, "child gene"], row, value) -> Int[Array, "child gene"]:
    room = values.shape[1]
    place = jnp.where(row < 0, room, row)
    return values.at[jnp.arange(len(row)), place].set(value, mode="drop")
