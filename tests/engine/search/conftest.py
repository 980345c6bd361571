"""Small archives, and outcomes of a generation."""

import jax.numpy as jnp
import pytest

from microcosmos import search
from microcosmos.search.cells import Axis, Grid


@pytest.fixture
def one_axis():
    """A function that makes `bins` equal cells along one measure from 0 to 1."""

    def make(bins):
        return Grid((Axis(measure=0, low=0.0, high=1.0, bins=bins, logarithmic=False),))

    return make


@pytest.fixture(scope="session")
def outcome_of():
    """A function that makes the outcome of children by their fitness; all enter cell 0."""

    def make(genotypes, fitness, **changes):
        fitness = jnp.asarray(fitness, jnp.float32)
        yes, nowhere = jnp.ones(len(fitness), bool), jnp.zeros(len(fitness), jnp.int32)
        flags = {"feasible": yes, "entered": yes, "fresh": ~yes, "cell": nowhere}
        measures = jnp.zeros((len(fitness), 1))
        given = {"measures": measures, "improvement": fitness} | flags | changes
        return search.Outcome(genotypes=genotypes, fitness=fitness, **given)

    return make
