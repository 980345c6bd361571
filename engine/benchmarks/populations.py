"""Populations of networks, grown to a size, that advance by generations."""

import time
from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import genomes, neat

INPUTS, OUTPUTS, NODES, CONNECTIONS = 4, 2, 50, 100
ANCESTORS, STEPS_APART = 8, 3
"""The number of ancestors, and of variations since their copies diverged."""
SETTINGS = neat.PRESETS["tensorneat"]
GROWTH = replace(SETTINGS.rates, add_node=0.5, add_connection=0.3, blind=False)
GROWTH = replace(GROWTH, delete_node=0.0, delete_connection=0.0)


first_species = jax.jit(partial(neat.first_species, settings=SETTINGS))
next_generation = jax.jit(
    partial(neat.next_generation, settings=SETTINGS, inputs=INPUTS, outputs=OUTPUTS)
)


class OurPopulation:
    """A population of ours that advances by generations."""

    def __init__(self, size: int, hidden: int) -> None:
        self.networks, self.counters = grown(size, hidden)
        self.species = first_species(self.networks)
        self.generation = 0
        self.random = np.random.default_rng(0)
        self.compilation = self.advance()

    def advance(self) -> float:
        """Advance by one generation; return its seconds."""
        fitness = jnp.float32(self.random.random(len(self.networks.weight)))
        now = (self.networks, fitness, self.species, self.counters)
        clock = {"key": jax.random.key(1), "generation": jnp.asarray(self.generation)}
        start = time.perf_counter()
        after = jax.block_until_ready(next_generation(*now, **clock))
        seconds = time.perf_counter() - start
        self.networks, self.species, self.counters = after[:3]
        self.generation += 1
        return seconds

    def sizes(self) -> tuple[float, float, int]:
        """Return mean hidden nodes and connections, and the number of species."""
        nodes = float(jnp.mean(jnp.sum(self.networks.node_used, 1))) - INPUTS - OUTPUTS
        connections = float(jnp.mean(jnp.sum(self.networks.connection_used, 1)))
        return nodes, connections, int(jnp.sum(self.species.alive))


def grown(size: int, hidden: int) -> tuple[genomes.CPPN, neat.Counters]:
    """Grow networks of about `hidden` hidden nodes from a few ancestors."""
    minimal = jax.vmap(lambda k: neat.minimal(k, INPUTS, OUTPUTS, NODES, CONNECTIONS))
    networks = minimal(jax.random.split(jax.random.key(0), size))
    counters = neat.first_counters(INPUTS, OUTPUTS)
    for step in range(2 * hidden):
        networks, counters = vary(networks, counters, jax.random.key(step))
        if step == 2 * hidden - STEPS_APART - 1:
            networks = jax.tree.map(lambda x: x[jnp.arange(size) % ANCESTORS], networks)
    return networks, counters


@jax.jit
def vary(networks, counters, key):
    keys = jax.random.split(key, len(networks.weight))
    mutate = jax.vmap(lambda n, k: neat.mutate(n, GROWTH, INPUTS, key=k))
    return neat.number(*mutate(networks, keys), counters)
