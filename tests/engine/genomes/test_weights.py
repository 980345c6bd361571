"""The weights of a network of given layers are genes."""

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import genomes, spec
from microcosmos.build import build_task

SIZES, SCALE = (3, 5, 4, 2), 1.7


def test_layers_compute_what_matrices_do(float64):
    layers = genomes.Layers(SIZES, "sin", SCALE)
    random = np.random.default_rng(0)
    genes, inputs = random.uniform(-1, 1, layers.genes), random.normal(size=(3, 7))
    values, rest = inputs, genes
    for before, after in ((3, 5), (5, 4), (4, 2)):
        rows, rest = rest[: after * (before + 1)], rest[after * (before + 1) :]
        rows = SCALE * rows.reshape(after, before + 1)
        values = rows[:, 1:] @ values + rows[:, :1]
        values = np.sin(values) if after != 2 else values
    found = genomes.forward(layers, jnp.asarray(genes), jnp.asarray(inputs))
    np.testing.assert_allclose(found, values, rtol=1e-12)
    assert not len(rest)


def test_size_and_genes_are_those_of_the_layers():
    control = spec.Weights(hidden=(5, 4))
    task = build_task(spec.Scene(control=control))
    genotype = task.encoding.newcomer(key=jax.random.key(0))
    hidden, connections = task.encoding.size(genotype)
    assert (hidden, connections) == (9, 3 * 5 + 5 * 4 + 4 * 2)
    assert genotype.values.shape == (3 * 5 + 5 + 5 * 4 + 4 + 4 * 2 + 2,)
    assert spec.gene_count(control, spec.shape(spec.Chain())) == len(genotype.values)
