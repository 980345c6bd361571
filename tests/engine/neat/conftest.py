"""Populations of networks, and NEAT's operators as plain Python over dictionaries."""

from dataclasses import replace
from functools import cache, partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, neat

INPUTS, OUTPUTS, NODES, CONNECTIONS, BATCH = 3, 2, 12, 30, 60


@pytest.fixture(scope="session")
def settings():
    """The paper's, with so much growth that small networks soon are full."""
    paper = neat.PRESETS["paper"]
    rates = replace(paper.rates, add_node=0.3, add_connection=0.4, toggle=0.05, weight_step=0.5)
    grown = replace(paper, rates=rates, coefficients=neat.Coefficients(1.0, 1.0, 0.4))
    species = {"threshold": 0.7, "max_species": 8, "interspecies": 0.05, "stagnation": 4}
    return replace(grown, **species)


@pytest.fixture(scope="session")
def shrinking(settings):
    """The same with deletion, TensorNEAT's way of choosing, and bounds."""
    preset = neat.PRESETS["tensorneat"]
    rates = replace(preset.rates, add_node=0.5, add_connection=0.6, bound=1.5)
    return replace(preset, rates=rates, threshold=0.4, max_species=8, survival=0.4)


@pytest.fixture(scope="session")
def begin():
    return cache(lambda settings: jax.jit(lambda n: neat.first_species(n, settings)))


@pytest.fixture(scope="session")
def advance():
    """A function that gives the program of a generation, compiled once for all tests."""

    @cache
    def program(settings):
        step = partial(neat.next_generation, settings=settings, inputs=INPUTS, outputs=OUTPUTS)
        return jax.jit(lambda n, f, s, c, k, g: step(n, f, s, c, key=k, generation=g))

    return program


@pytest.fixture(scope="session")
def evolve(begin, advance):
    def run(settings, generations, seed=0, broken=0.1):
        key = jax.random.key(seed)
        networks = newcomers(jax.random.split(key, BATCH))
        species, counters = begin(settings)(networks), neat.first_counters(INPUTS, OUTPUTS)
        random = np.random.default_rng(seed)
        history = []
        for generation in range(generations):
            fitness = random.normal(size=BATCH).astype(np.float32)
            fitness[random.random(BATCH) < broken] = random.choice([np.nan, -np.inf])
            now = networks, jnp.asarray(fitness), species, counters
            after = advance(settings)(*now, key, jnp.asarray(generation))
            history.append(jax.device_get((*now, after[3], after[4])))
            networks, species, counters = after[:3]
        history.append(jax.device_get((networks, None, species, counters, None, None)))
        return history

    return run


@jax.jit
def newcomers(keys):
    sizes = (INPUTS, OUTPUTS, NODES, CONNECTIONS)
    return jax.vmap(lambda key: neat.minimal(key, *sizes))(keys)


@pytest.fixture(scope="session")
def grown(evolve, settings):
    return evolve(settings, 14)


@pytest.fixture(scope="session")
def shrunk(evolve, shrinking):
    """Fourteen generations in which genes are lost as well."""
    return evolve(shrinking, 14)


@pytest.fixture(scope="session")
def vary():
    """The program that mutates and numbers a batch without selection."""
    rates = neat.Rates(0.5, 0.5, 0.1, 0.2, toggle=0.1, add_node=0.6, add_connection=0.8)

    @jax.jit
    def program(networks, counters, key):
        mutate = jax.vmap(lambda n, k: neat.mutate(n, rates, INPUTS, key=k))
        keys = jax.random.split(key, networks.weight.shape[0])
        return neat.number(*mutate(networks, keys), counters)

    return program


@pytest.fixture(scope="session")
def mutated(vary):
    """Fifteen generations of unselected mutation, as `evolve` keeps them."""
    networks = newcomers(jax.random.split(jax.random.key(0), 32))
    counters = neat.first_counters(INPUTS, OUTPUTS)
    history = [(networks, None, None, counters)]
    for number in range(15):
        networks, counters = vary(networks, counters, jax.random.key(number + 1))
        history.append((networks, None, None, counters))
    return jax.device_get(history)


@pytest.fixture(scope="session")
def genes_of():
    """A function that gives the genes of one network, by their numbers."""

    def read(network):
        nodes = {
            int(network.node_id[row]): (int(network.activation[row]), float(network.bias[row]))
            for row in np.flatnonzero(network.node_used)
        }
        connections = {
            int(network.innovation[row]): (
                int(network.node_id[network.source[row]]),
                int(network.node_id[network.target[row]]),
                bool(network.enabled[row]),
                float(network.weight[row]),
            )
            for row in np.flatnonzero(network.connection_used)
        }
        return nodes, connections

    return read


@pytest.fixture(scope="session")
def plain_distance(genes_of):
    """The paper's equation 1, over dictionaries."""

    def measure(a, b, coefficients):
        a, b = genes_of(a)[1], genes_of(b)[1]
        shared = a.keys() & b.keys()
        last = min(max(a, default=-1), max(b, default=-1))
        alone = a.keys() ^ b.keys()
        excess = sum(number > last for number in alone)
        many = max(len(a), len(b), 1)
        if many <= coefficients.small:
            many = 1
        unlike = [abs(a[n][3] - b[n][3]) for n in shared]
        return (
            coefficients.excess * excess / many
            + coefficients.disjoint * (len(alone) - excess) / many
            + coefficients.weight * (float(np.mean(unlike)) if shared else 0.0)
        )

    return measure


@pytest.fixture(scope="session")
def each():
    def split(networks):
        return [genomes.take(networks, i) for i in range(networks.weight.shape[0])]

    return split
