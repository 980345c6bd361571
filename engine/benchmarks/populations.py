"""Populations of networks, grown to a size, that take one generation after the other."""

import time
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import genomes, neat

INPUTS, OUTPUTS, NODES, CONNECTIONS = 4, 2, 50, 100
LINES, STEPS_APART = 8, 3
"""Networks descend from so many ancestors, and vary on their own so often since."""
SETTINGS = neat.PRESETS["tensorneat"]
GROWTH = replace(SETTINGS.rates, add_node=0.5, add_connection=0.3, blind=False)
GROWTH = replace(GROWTH, delete_node=0.0, delete_connection=0.0)


@jax.jit
def divide(networks):
    return neat.first_species(networks, SETTINGS)


@jax.jit
def follow(networks, fitness, species, counters, generation):
    return neat.next_generation(
        networks,
        fitness,
        species,
        counters,
        SETTINGS,
        inputs=INPUTS,
        outputs=OUTPUTS,
        key=jax.random.key(1),
        generation=generation,
    )


class Ours:
    """A population of ours that takes one generation after the other."""

    def __init__(self, size: int, hidden: int) -> None:
        self.networks, self.counters = grown(size, hidden)
        self.species = divide(self.networks)
        self.generation = 0
        self.random = np.random.default_rng(0)
        began = time.perf_counter()
        self.advance()
        self.compiling = time.perf_counter() - began

    def advance(self) -> float:
        """The seconds of one generation."""
        fitness = jnp.float32(self.random.random(len(self.networks.weight)))
        began = time.perf_counter()
        after = jax.block_until_ready(
            follow(
                self.networks,
                fitness,
                self.species,
                self.counters,
                jnp.asarray(self.generation),
            )
        )
        seconds = time.perf_counter() - began
        self.networks, self.species, self.counters = after[:3]
        self.generation += 1
        return seconds

    def sizes(self) -> tuple[float, float, int]:
        """Mean hidden nodes and connections, and the number of species."""
        nodes = float(jnp.mean(jnp.sum(self.networks.node_used, 1))) - INPUTS - OUTPUTS
        connections = float(jnp.mean(jnp.sum(self.networks.connection_used, 1)))
        return nodes, connections, int(jnp.sum(self.species.alive))


def grown(size: int, hidden: int) -> tuple[genomes.CPPN, neat.Counters]:
    """Networks of about so many hidden nodes, from a few ancestors."""
    minimal = jax.vmap(lambda k: neat.minimal(k, INPUTS, OUTPUTS, NODES, CONNECTIONS))
    networks = minimal(jax.random.split(jax.random.key(0), size))
    counters = neat.first_counters(INPUTS, OUTPUTS)
    for step in range(2 * hidden):
        networks, counters = vary(networks, counters, jax.random.key(step))
        if step == 2 * hidden - STEPS_APART - 1:
            networks = jax.tree.map(lambda x: x[jnp.arange(size) % LINES], networks)
    return networks, counters


@jax.jit
def vary(networks, counters, key):
    keys = jax.random.split(key, len(networks.weight))
    mutate = jax.vmap(lambda n, k: neat.mutate(n, GROWTH, INPUTS, key=k))
    return neat.number(*mutate(networks, keys), counters)
