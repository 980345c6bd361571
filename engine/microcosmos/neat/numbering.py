"""Numbering of new genes: equal mutations in a generation get equal numbers."""

from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from ..bodies.growth import FIRST_LIMBS, Plan
from ..genomes import CPPN, BodyGraph, Graph
from .mutation import Novelty
from .plans import PlanNovelty
from .rows import NONE


class Counters(eqx.Module):
    """The next unused numbers."""

    innovation: Int[Array, ""]
    node: Int[Array, ""]
    segment: Int[Array, ""]


def first_counters(inputs: int, outputs: int) -> Counters:
    """Return the counters after the genes of minimal networks."""
    # Strong types: weak ones would compile programs anew.
    first = inputs * outputs, inputs + outputs, 1 + FIRST_LIMBS
    return Counters(*(jnp.asarray(one, int) for one in first))


def number(children: Graph, novelty: Novelty, counters: Counters) -> tuple[Graph, Counters]:
    """Number the new genes of a batch."""
    if not isinstance(children, BodyGraph):
        return number_network(children, novelty, counters)
    assert novelty.segment is not None
    network, counters = number_network(children.network, novelty, counters)
    plan, many = number_plan(children.plan, novelty.segment, counters.segment)
    counters = replace(counters, segment=counters.segment + many)
    return BodyGraph(plan, network), counters


def number_plan(
    plans: Plan, novelty: PlanNovelty, first: Int[Array, ""]
) -> tuple[Plan, Int[Array, ""]]:
    """Number new segments from `first` on; also return the count of numbers used.

    New segments get equal numbers if the same operation attaches them to, or splits them from,
    segments of equal number.
    """
    rank, many = ranks(novelty.of, novelty.operation)
    return plans._replace(number=_assign(plans.number, novelty.row, first + rank)), many


def number_network(
    children: CPPN, novelty: Novelty, counters: Counters
) -> tuple[CPPN, Counters]:
    """Number new genes of networks; added connections come before split ones."""
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
    return children, replace(
        counters,
        innovation=counters.innovation + many_added + 2 * many_split,
        node=counters.node + many_split,
    )


def compacted(children: Graph, before: Counters) -> tuple[Graph, Counters]:
    """Return children with dense numbers from the counters `before` on, in their order.

    Children that have left the batch leave gaps in its numbers. Takes and returns NumPy arrays;
    the new counters come after the numbers in use.
    """
    network: Any = children.network if isinstance(children, BodyGraph) else children
    innovation, one = _dense(network.innovation, network.connection_used, before.innovation)
    node, two = _dense(network.node_id, network.node_used, before.node)
    network = eqx.tree_at(lambda n: (n.innovation, n.node_id), network, (innovation, node))
    if not isinstance(children, BodyGraph):
        return network, Counters(one, two, before.segment)
    segment, three = _dense(children.plan.number, children.plan.used, before.segment)
    plan = children.plan._replace(number=segment)
    return BodyGraph(plan, network), Counters(one, two, three)


def _dense(
    numbers: Int[np.ndarray, "child gene"],
    used: Bool[np.ndarray, "child gene"],
    first: Int[Array, ""],
) -> tuple[Int[np.ndarray, "child gene"], Int[Array, ""]]:
    start = int(first)
    new = used & (numbers >= start)
    in_use = np.unique(numbers[new])
    dense = start + np.searchsorted(in_use, numbers)
    dense = np.where(new, dense, numbers).astype(numbers.dtype)
    return dense, jnp.asarray(start + len(in_use), first.dtype)


def ranks(
    first: Int[Array, "child"], second: Int[Array, "child"]
) -> tuple[Int[Array, "child"], Int[Array, ""]]:
    """Return each child's rank among the distinct pairs, and their number.

    A negative `first` means no pair.
    """
    order = jnp.lexsort((second, first))
    a, b = first[order], second[order]
    # Sorted, equal pairs are adjacent, and children without a pair (negative) come first.
    changed = (a != jnp.roll(a, 1)) | (b != jnp.roll(b, 1))
    changed = changed.at[0].set(True) & (a >= 0)
    place = jnp.cumsum(changed) - 1
    return jnp.zeros_like(first).at[order].set(jnp.maximum(place, 0)), jnp.sum(changed)


def _assign(values: Int[Array, "child gene"], row, value) -> Int[Array, "child gene"]:
    # An absent row points behind the last one, where writes are dropped: −1 would be the last.
    room = values.shape[1]
    place = jnp.where(row < 0, room, row)
    return values.at[jnp.arange(len(row)), place].set(value, mode="drop")
