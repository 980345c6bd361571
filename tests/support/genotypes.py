"""Networks from their links, and random genotypes of every encoding."""

from typing import Any

import body_plans
import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import genomes, spec
from microcosmos.neat import PlanRates


def network_of(links, inputs, activations, biases, *, dtype="float32", room=(12, 16)):
    """Make a CPPN from its links, activations and biases."""
    genes, names = genomes.empty(*room), list(genomes.ACTIVATIONS)
    used, count = inputs + len(activations), len(links)
    genes.node_used[:used], genes.node_id[:used] = True, np.arange(used)
    genes.activation[inputs:used] = [names.index(name) for name in activations]
    genes.bias[inputs:used] = biases
    genes.connection_used[:count] = genes.enabled[:count] = True
    genes.innovation[:count] = np.arange(count)
    genes.source[:count], genes.target[:count] = np.transpose(list(links))
    genes.weight[:count] = list(links.values())
    return jax.tree.map(
        lambda x: jnp.asarray(x, dtype if x.dtype == np.float32 else None), genes
    )


def any_network(control: Any, rng: np.random.Generator) -> genomes.CPPN:
    """Draw a network with hidden nodes, and with cycles where they are allowed."""
    inputs, outputs = len(control.inputs), len(control.outputs)
    first = inputs + outputs
    links = {(i, o): rng.normal() for i in range(inputs) for o in range(inputs, first)}
    for hidden in range(first, first + 3):
        before = int(rng.integers(inputs)) if hidden == first else hidden - 1
        after = inputs + int(rng.integers(outputs))
        links |= {(before, hidden): rng.normal(), (hidden, after): rng.normal()}
    if getattr(control, "recurrent", False):
        links |= {(first, first): 0.5, (first + 2, first): -0.7}
    kinds = rng.choice(list(genomes.ACTIVATIONS), outputs + 3)
    biases = rng.normal(size=outputs + 3)
    return network_of(links, inputs, kinds, biases, room=(first + 4, len(links) + 2))


def padded(network: genomes.CPPN, room: tuple[int, int]) -> genomes.CPPN:
    """Return a network with room for more genes."""
    larger = genomes.empty(*room)
    for name, column in vars(network).items():
        getattr(larger, name)[: len(column)] = column
    return jax.tree.map(jnp.asarray, larger)


def any_genotype(
    scene: spec.Scene, encoding: genomes.Encoding, rng: np.random.Generator
) -> genomes.Genotype:
    """Draw a genotype of a scene."""
    if isinstance(scene.control, spec.BodyGraph):
        assert isinstance(scene.body, spec.GrownBody)
        rates = PlanRates(scene.body.genes, structure=0.7, values=0.3, vary=0.9)
        key = jax.random.key(int(rng.integers(2**31)))
        plan = jax.jit(lambda key: body_plans.mutated(key, 8, rates))(key)
        return genomes.BodyGraph(plan, any_network(scene.control, rng))
    if isinstance(scene.control, spec.Control):
        return any_network(scene.control, rng)
    genes = encoding.newcomer(key=jax.random.key(0)).values.shape
    scale = 0.1 if isinstance(scene.control, spec.Fold) else 1.0
    return genomes.Vector(jnp.float32(rng.uniform(-scale, scale, genes)))
