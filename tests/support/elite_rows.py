"""Random candidates for an archive, among them those with odd numbers."""

from dataclasses import replace

import jax
import numpy as np

from microcosmos import search
from microcosmos.device import array

AXES = (
    search.Axis(measure=0, low=1e-4, high=1e2, bins=6, logarithmic=True),
    search.Axis(measure=1, low=0.0, high=1.0, bins=4, logarithmic=False),
)
AWKWARD = [np.nan, np.inf, -np.inf, 1e38, -1e38, -0.0, 0.0, 1e-40, -1e-40, 1.0, -1.0]


def candidates(genotypes, count, seed, generation=0, levels=4):
    """Random rows in which equal fitness and equal cells are common."""
    random = np.random.default_rng(seed)
    first, second = 10 ** random.uniform(-5, 3, count), random.uniform(-0.2, 1.2, count)
    measures = np.stack([first, second], 1)
    return search.Elites(
        occupied=array(random.random(count) < 0.9),
        fitness=array(random.integers(0, levels, count), np.float32),
        measures=array(measures, np.float32),
        generation=array(np.full(count, generation), np.int32),
        slot=array(np.arange(count), np.int32),
        curiosity=array(np.ones(count), np.float32),
        genotypes=genotypes(random, count),
    )


def awkward(genotypes, count, seed, generation=0):
    """The same with every kind of odd number in fitness and descriptors."""
    rows = candidates(genotypes, count, seed, generation)
    random = np.random.default_rng(seed)
    fitness, measures = np.array(rows.fitness), np.array(rows.measures)
    odd = random.random(count) < 0.6
    fitness[odd] = random.choice(AWKWARD, odd.sum())
    odd = random.random((count, 2)) < 0.4
    measures[odd] = random.choice(AWKWARD, odd.sum())
    return replace(rows, fitness=array(fitness), measures=array(measures))


def same(a, b):
    pairs = zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True)
    return all(np.asarray(x).tobytes() == np.asarray(y).tobytes() for x, y in pairs)
