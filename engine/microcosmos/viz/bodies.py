"""Bodies of creatures as their genes made them, without JAX: grown, cut and softened."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..bodies import Body, extent, growth
from ..naming import ACTIVATIONS, decode, decoded
from ..spec import BodyGraph, Direct, Grown, GrownBody, Scene, shape
from .networks import from_genes
from .networks.functions import BOUND
from .networks.grown import grown_chain
from .networks.network import Link, Network, Node

Genes = Mapping[str, Any]
"""The genome of a creature's identity."""
SEGMENT = "segment_"
"""Prefix of the columns of a plan in an archive file."""


def body_of(scene: Scene, genes: Genes) -> Body:
    """Return the body of a creature at rest, with the stiffness of its joints."""
    control, whole = scene.control, scene.body
    if isinstance(control, BodyGraph) and isinstance(whole, GrownBody):
        return growth.grown_body(_plan(genes, whole), whole.capacity, control.softest)
    if isinstance(control, Grown):
        network = from_genes(genes, control.inputs, control.outputs)
        return grown_chain(network, control, shape(whole))
    if isinstance(control, Direct):
        return _inherited(control, shape(whole), decode(genes["values"]))
    return shape(whole)


def length_of(scene: Scene, genes: Genes) -> float:
    """Return the reach of a creature's body, in cells: the longest way along its edges."""
    if isinstance(scene.body, GrownBody):
        return growth.grown_length(_plan(genes, scene.body), scene.body.capacity)
    if isinstance(scene.control, Grown):
        return float(body_of(scene, genes).rest_length.sum())
    return extent(shape(scene.body))


def elites(scene: Scene, genomes: Mapping[str, np.ndarray]) -> Iterator[Body]:
    """Yield the body of each elite of an archive file from its `archive/genomes`."""
    count = len(next(iter(genomes.values())))
    control, whole = scene.control, shape(scene.body)
    for row in range(count):
        found = {name: values[row] for name, values in genomes.items()}
        if isinstance(control, BodyGraph) and isinstance(scene.body, GrownBody):
            fields = growth.Plan._fields
            plan = growth.Plan(**{name: found[SEGMENT + name] for name in fields})
            yield growth.grown_body(plan, scene.body.capacity, control.softest)
        elif isinstance(control, Grown):
            yield grown_chain(_network(found, control), control, whole)
        elif isinstance(control, Direct):
            yield _inherited(control, whole, found["values"])
        else:
            yield whole


def _plan(genes: Genes, body: GrownBody) -> growth.Plan:
    return growth.plan_of(decoded(genes["plan"]), body.segments)


def _inherited(control: Direct, body: Body, values: np.ndarray) -> Body:
    """Return the body with the stiffness in its genes, whose traits come first."""
    parts, found, used = control.parts(body), {}, 0
    for name, (low, high) in control.traits.items():
        genes = values[used : used + parts[name]].astype(float)
        found[name] = low + (high - low) * 0.5 * (1 + genes)
        used += parts[name]
    soft = {name: found[name] for name in ("stretch", "shear", "bend") if name in found}
    return replace(body, **soft)


def _network(row: Mapping[str, np.ndarray], control: Grown) -> Network:
    """Return the network in a row of an archive file."""
    used, kept = row["node_used"], row["connection_used"] & row["enabled"]
    keys = row["node_id"][used].tolist()
    words = [ACTIVATIONS[number] for number in row["activation"][used].tolist()]
    nodes = zip(keys, row["bias"][used].tolist(), words, strict=True)
    columns = (row[name][kept].tolist() for name in ("source", "target", "weight"))
    first = len(control.inputs)
    return Network(
        inputs=first,
        outputs=tuple(keys[first : first + len(control.outputs)]),
        nodes=tuple(Node(key, bias, activation=word) for key, bias, word in nodes),
        links=tuple(Link(keys[a], keys[b], w) for a, b, w in zip(*columns, strict=True)),
        rule="always",
        bound=BOUND,
    )
