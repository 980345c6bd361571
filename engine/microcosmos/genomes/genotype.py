"""Genotypes, which are networks of genes or vectors, and their form in a creature file."""

from collections.abc import Mapping
from typing import Any, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray, UInt32

from ..bodies.growth import Plan, plan_of
from ..naming import ACTIVATIONS, decode, decoded, encode
from .cppn import CPPN
from .encoding import Encoding


class BodyGraph(eqx.Module):
    """A genotype of two parts: the plan grows the body, the network drives it."""

    plan: Plan
    network: CPPN


T = TypeVar("T")
NEGATIVE_ZERO = np.uint32(1 << 31)


class Vector(eqx.Module):
    """Genes that are numbers; the encoding gives each its meaning."""

    values: Float[Array, "*batch gene"]


Graph = CPPN | BodyGraph
"""Genotypes with numbered genes, which NEAT varies."""

Genotype = Graph | Vector


def uniform_vector(genes: int, spread: float, *, key: PRNGKeyArray) -> Vector:
    """Draw genes uniformly within ± `spread`."""
    return Vector(jax.random.uniform(key, (genes,), jnp.float32, -spread, spread))


SEGMENT = "segment_"
"""Prefix of the names of a plan's columns."""


def columns(genotypes: Genotype) -> dict[str, Any]:
    """Return the arrays of a genotype, or of a batch, by name."""
    if isinstance(genotypes, BodyGraph):
        plan = {SEGMENT + name: x for name, x in genotypes.plan._asdict().items()}
        return plan | vars(genotypes.network)
    return vars(genotypes)


def from_columns(form: Genotype, given: Mapping[str, Any]) -> Genotype:
    """Return the genotypes with these columns, of the kind of `form`."""
    leaves = [given[name] for name in columns(form)]
    return jax.tree.unflatten(jax.tree.structure(form), leaves)


def words(genotypes: Genotype) -> UInt32[Array, "row word"]:
    """Return every gene of a batch as 32 bits, with −0 as 0."""
    if isinstance(genotypes, Vector):
        return _bits(genotypes.values)
    if isinstance(genotypes, BodyGraph):
        plan = [
            _bits(one) if jnp.issubdtype(one.dtype, jnp.floating) else one
            for one in genotypes.plan
        ]
        parts = [one.astype(jnp.uint32) for one in plan]
        return jnp.concatenate([*parts, words(genotypes.network)], 1)
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
    bits = jax.lax.bitcast_convert_type(values.astype(jnp.float32), jnp.uint32)
    # Not by adding 0, as `naming.encode` does: XLA leaves such a sum out.
    return jnp.where(bits == NEGATIVE_ZERO, np.uint32(0), bits)


def take(genotypes: T, index: int) -> T:
    """Return one genotype of a batch as NumPy arrays."""
    return jax.tree.map(lambda x: np.asarray(x)[index], genotypes)


def write(genotype: Genotype) -> dict[str, Any]:
    """Return the genes of one genotype of NumPy arrays as a creature file holds them."""
    if isinstance(genotype, BodyGraph):
        return {"plan": to_segments(genotype.plan), **to_genes(genotype.network)}
    if isinstance(genotype, CPPN):
        return to_genes(genotype)
    return {"values": encode(np.asarray(genotype.values))}


def read(genes: Mapping[str, Any], encoding: Encoding) -> Genotype:
    """Return the genotype of a parsed creature file as NumPy arrays of the encoding's sizes."""
    room = encoding.room
    if room is not None and encoding.segments is not None:
        plan = plan_of(decoded(genes["plan"]), encoding.segments.rows)
        return BodyGraph(plan, from_genes(genes, *room))
    if room is not None:
        return from_genes(genes, *room)
    return jax.tree.map(np.array, Vector(jnp.asarray(decode(genes["values"]), jnp.float32)))


def to_segments(plan: Plan) -> dict[str, Any]:
    """Return the used genes of one plan of NumPy arrays."""
    count = int(plan.used.sum())
    columns = {name: np.asarray(getattr(plan, name))[:count] for name in Plan._fields[1:]}
    return {
        name: encode(column) if column.dtype == np.float32 else column.tolist()
        for name, column in columns.items()
    }


def to_genes(network: CPPN) -> dict[str, Any]:
    """Return the used genes of one network of NumPy arrays."""
    n, c = int(network.node_used.sum()), int(network.connection_used.sum())
    ids = network.node_id
    return {
        "nodes": {
            "id": ids[:n].tolist(),
            "activation": [ACTIVATIONS[a] for a in network.activation[:n].tolist()],
            "bias": encode(np.asarray(network.bias[:n])),
        },
        "connections": {
            "innovation": network.innovation[:c].tolist(),
            "source": ids[network.source[:c]].tolist(),
            "target": ids[network.target[:c]].tolist(),
            "enabled": network.enabled[:c].tolist(),
            "weight": encode(np.asarray(network.weight[:c])),
        },
    }


def from_genes(genes: Mapping[str, Any], max_nodes: int, max_connections: int) -> CPPN:
    """Return the network of a parsed creature file, with room for more genes."""
    nodes, connections = genes["nodes"], genes["connections"]
    row = {number: row for row, number in enumerate(nodes["id"])}
    network = empty(max_nodes, max_connections)
    n, c = len(row), len(connections["innovation"])
    network.node_used[:n] = True
    network.node_id[:n] = nodes["id"]
    network.activation[:n] = [ACTIVATIONS.index(a) for a in nodes["activation"]]
    network.bias[:n] = decode(nodes["bias"])
    network.connection_used[:c] = True
    network.innovation[:c] = connections["innovation"]
    network.source[:c] = [row[number] for number in connections["source"]]
    network.target[:c] = [row[number] for number in connections["target"]]
    network.enabled[:c] = connections["enabled"]
    network.weight[:c] = decode(connections["weight"])
    return network


def empty(max_nodes: int, max_connections: int, batch: tuple[int, ...] = ()) -> CPPN:
    """Return a network without any gene, as writable NumPy arrays."""
    node, connection = (*batch, max_nodes), (*batch, max_connections)
    network = CPPN(
        node_used=jnp.zeros(node, bool),
        node_id=jnp.zeros(node, jnp.int32),
        activation=jnp.zeros(node, jnp.int32),
        bias=jnp.zeros(node, jnp.float32),
        connection_used=jnp.zeros(connection, bool),
        innovation=jnp.zeros(connection, jnp.int32),
        source=jnp.zeros(connection, jnp.int32),
        target=jnp.zeros(connection, jnp.int32),
        enabled=jnp.zeros(connection, bool),
        weight=jnp.zeros(connection, jnp.float32),
    )
    return jax.tree.map(np.array, network)
