"""What a NEAT generation costs beside neat-python's, how fast networks are, and XOR.

Prints tables and asserts nothing; `engine/benchmarks/neat.py 100` solves XOR with so many
seeds. neat-python is compared with where it is importable: `pip install --target PEERS
neat-python==2.0.0` and PYTHONPATH=PEERS. Both run interleaved in one process; compilation
is told and not counted.
"""

import importlib
import random
import statistics
import sys
import tempfile
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import device, genomes, neat

INPUTS, OUTPUTS, NODES, CONNECTIONS = 4, 2, 50, 100
LINES, STEPS_APART = 8, 3
"""Networks descend from so many ancestors, and vary on their own so often since."""
POINTS = 64
SIZES = ((1_000, 11, 3), (10_000, 5, 1))
"""Networks, and how often ours and neat-python are timed, which is slow."""
SETTINGS = neat.PRESETS["tensorneat"]
GROWTH = replace(SETTINGS.rates, add_node=0.5, add_connection=0.3, blind=False)
GROWTH = replace(GROWTH, delete_node=0.0, delete_connection=0.0)

XOR = neat.PRESETS["paper"]
XOR_INPUTS, CORNERS, EXPECTED = 2, ((0, 0, 1, 1), (0, 1, 0, 1)), (0, 1, 1, 0)
"""Nodes have biases of their own; the paper has a third input that is always 1."""
ROOM = (16, 40)
STEEPNESS = 4.9
"""Of the paper's sigmoid; here weights and biases are multiplied by it."""
GENERATIONS = 90
"""As many as the paper's slowest run took."""
FIRST_SEED = 1000
"""Settings were chosen with smaller ones."""

CONFIG = """
[NEAT]
fitness_criterion = max
fitness_threshold = 1e9
no_fitness_termination = True
pop_size = {size}
reset_on_extinction = False
[DefaultGenome]
num_inputs = 4
num_outputs = 2
num_hidden = 0
feed_forward = True
initial_connection = full_direct
compatibility_disjoint_coefficient = 1.0
compatibility_weight_coefficient = 0.4
conn_add_prob = 0.2
conn_delete_prob = 0.2
node_add_prob = 0.1
node_delete_prob = 0.1
activation_default = sigmoid
activation_options = sigmoid
activation_mutate_rate = 0.1
aggregation_default = sum
aggregation_options = sum
aggregation_mutate_rate = 0.0
bias_init_mean = 0.0
bias_init_stdev = 1.0
bias_replace_rate = 0.015
bias_mutate_rate = 0.2
bias_mutate_power = 0.15
bias_max_value = 5.0
bias_min_value = -5.0
response_init_mean = 1.0
response_init_stdev = 0.0
response_replace_rate = 0.0
response_mutate_rate = 0.0
response_mutate_power = 0.0
response_max_value = 5.0
response_min_value = -5.0
weight_init_mean = 0.0
weight_init_stdev = 1.0
weight_replace_rate = 0.015
weight_mutate_rate = 0.2
weight_mutate_power = 0.15
weight_max_value = 5.0
weight_min_value = -5.0
enabled_default = True
enabled_mutate_rate = 0.0
[DefaultSpeciesSet]
compatibility_threshold = 2.0
[DefaultStagnation]
species_fitness_func = max
max_stagnation = 15
species_elitism = 2
[DefaultReproduction]
elitism = 2
survival_threshold = 0.1
min_species_size = 1
"""
"""TensorNEAT's defaults, as far as neat-python has them: what ours is given too."""


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
        """Of the first population of a size."""

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


class Theirs:
    """A population of neat-python's that takes one generation after the other."""

    def __init__(self, peer: Any, size: int, hidden: int) -> None:
        with tempfile.NamedTemporaryFile("w", suffix=".cfg") as file:
            file.write(CONFIG.format(size=size))
            file.flush()
            self.config = peer.Config(
                peer.DefaultGenome,
                peer.DefaultReproduction,
                peer.DefaultSpeciesSet,
                peer.DefaultStagnation,
                file.name,
            )
        random.seed(0)
        self.population = peer.Population(self.config)
        self._grow(hidden)

    def _grow(self, hidden: int) -> None:
        """As `grown`: each network a copy of one of few ancestors, then varied."""
        settings, people = self.config.genome_config, self.population.population
        ancestors = list(people.values())[:LINES]
        for one in ancestors:
            for _ in range(2 * hidden - STEPS_APART):
                self._vary(one, settings)
        for place, one in enumerate(people.values()):
            if place >= LINES:
                ancestor = ancestors[place % LINES]
                one.nodes = {k: gene.copy() for k, gene in ancestor.nodes.items()}
                one.connections = {k: gene.copy() for k, gene in ancestor.connections.items()}
        for one in people.values():
            for _ in range(STEPS_APART):
                self._vary(one, settings)
        self.population.species.species.clear()
        self.population.species.speciate(self.config, people, 0)

    def _vary(self, network: Any, settings: Any) -> None:
        if random.random() < GROWTH.add_connection:
            network.mutate_add_connection(settings)
        if random.random() < GROWTH.add_node:
            network.mutate_add_node(settings)

    def advance(self) -> float:
        """The seconds of one generation."""
        it, config = self.population, self.config
        for network in it.population.values():
            network.fitness = random.random()
        began = time.perf_counter()
        it.population = it.reproduction.reproduce(
            config, it.species, config.pop_size, it.generation
        )
        it.species.speciate(config, it.population, it.generation)
        seconds = time.perf_counter() - began
        it.generation += 1
        return seconds

    def sizes(self) -> tuple[float, float, int]:
        """Mean hidden nodes and connections, and the number of species."""
        people = list(self.population.population.values())
        nodes = statistics.mean(len(one.nodes) for one in people) - OUTPUTS
        connections = statistics.mean(len(one.connections) for one in people)
        return nodes, connections, len(self.population.species.species)


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


def main() -> None:
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    device.prepare()
    peer = imported_peer()
    for size, *repeats in SIZES:
        for hidden in (10, 30):
            compare(peer, size, hidden, *repeats)
    for hidden in (10, 30):
        forward(hidden)
    xor(seeds)


def imported_peer() -> Any:
    """neat-python, or None; not this file, which has its name."""
    sys.path = [p for p in sys.path if Path(p or ".").resolve() != Path(__file__).parent]
    try:
        return importlib.import_module("neat")
    except ImportError:
        print("neat-python is not importable: see the first lines of this file\n")
        return None


def compare(peer: Any, size: int, hidden: int, repeats: int, slow: int) -> None:
    """A row each: the median time of a generation, and its ratio."""
    ours = Ours(size, hidden)
    theirs = Theirs(peer, size, hidden) if peer else None
    seconds: dict[str, list[float]] = {"ours": [], "neat-python": []}
    for repeat in range(repeats):
        seconds["ours"].append(ours.advance())
        if theirs and repeat < slow:
            seconds["neat-python"].append(theirs.advance())
    print(f"next generation of {size} networks, {repeats} and {slow} repeats, interleaved")
    for name, population in (("ours", ours), ("neat-python", theirs)):
        if population:
            nodes, connections, species = population.sizes()
            print(
                f"  {name:12} {1e3 * statistics.median(seconds[name]):9.1f} ms"
                f"   hidden {nodes:5.1f}  connections {connections:5.1f}  species {species}"
            )
    if theirs:
        ratio = statistics.median(seconds["neat-python"]) / statistics.median(seconds["ours"])
        print(
            f"  neat-python takes {ratio:.1f} times as long; compilation {ours.compiling:.1f} s"
        )
    print(flush=True)


def forward(hidden: int) -> None:
    """Networks a second on a batch of points."""
    networks, _ = grown(1_000, hidden)
    points = jax.random.normal(jax.random.key(1), (INPUTS, POINTS))
    program = jax.jit(jax.vmap(lambda n: genomes.evaluate(n, points, OUTPUTS)))
    jax.block_until_ready(program(networks))
    seconds = []
    for _ in range(11):
        began = time.perf_counter()
        jax.block_until_ready(program(networks))
        seconds.append(time.perf_counter() - began)
    rate = 1_000 / statistics.median(seconds)
    print(f"forward, {hidden} hidden nodes: {rate:,.0f} networks × {POINTS} points a second\n")


def xor(seeds: int) -> None:
    """How many seeds solve XOR, and after how many evaluations."""
    keys = jax.vmap(jax.random.key)(FIRST_SEED + jnp.arange(seeds))
    results = np.stack(jax.device_get(jax.jit(partial(jax.lax.map, solve))(keys)), 1)
    done = results[:, 0] > 0
    evaluations, hidden = XOR.population * results[done, 1], results[done, 2]
    print(f"XOR: solved with {done.sum()} of {seeds} seeds in {GENERATIONS} generations")
    print("  evaluations           median     mean    worst   hidden nodes")
    print(
        f"  ours              {np.median(evaluations):10,.0f} {evaluations.mean():8,.0f}"
        f" {evaluations.max():8,.0f}   {hidden.mean():.2f}"
    )
    print("  paper, 100 runs            –    4,755   13,459   2.35")


def solve(key: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Whether XOR was solved, the generations evaluated, and the solution's hidden nodes."""
    step = partial(neat.next_generation, settings=XOR, inputs=XOR_INPUTS, outputs=1, key=key)
    networks = jax.vmap(beginner)(jax.random.split(key, XOR.population))
    start = (
        networks,
        neat.first_species(networks, XOR),
        neat.first_counters(XOR_INPUTS, 1),
        jnp.asarray(0),
        jnp.asarray(False),
        jnp.asarray(0),
    )

    def advance(state):
        networks, species, counters, generation, _, _ = state
        fitness, right = jax.vmap(judge)(networks)
        hidden = jnp.sum(networks.node_used[jnp.argmax(right)]) - XOR_INPUTS - 1
        after = step(networks, fitness, species, counters, generation=generation)
        return (*after[:3], generation + 1, jnp.any(right), hidden)

    end = jax.lax.while_loop(lambda s: ~s[4] & (s[3] < GENERATIONS), advance, start)
    return end[4], end[3], end[5]


def beginner(key: jax.Array) -> genomes.CPPN:
    """A minimal network of sigmoids."""
    return neat.minimal(key, XOR_INPUTS, 1, *ROOM, XOR.rates.palette)


def judge(network: genomes.CPPN) -> tuple[jax.Array, jax.Array]:
    """The paper's fitness, (4 − Σ|error|)², and whether all four answers are right."""
    steep = replace(network, weight=STEEPNESS * network.weight, bias=STEEPNESS * network.bias)
    out = genomes.evaluate(steep, jnp.float32(CORNERS), 1)[0]
    expected = jnp.float32(EXPECTED)
    error = jnp.sum(jnp.abs(out - expected))
    return (4 - error) ** 2, jnp.all((out > 0.5) == (expected > 0.5))


if __name__ == "__main__":
    main()
