"""A population of neat-python, grown and timed like ours in `populations.py`."""

import random
import statistics
import tempfile
import time
from typing import Any

from populations import ANCESTORS, GROWTH, OUTPUTS, STEPS_APART

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
{genes}
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
"""TensorNEAT's defaults, which ours use too, as far as neat-python has them."""

LIMITS = {"max_value": 5.0, "min_value": -5.0}
VARIED = {"init_mean": 0.0, "init_stdev": 1.0, "replace_rate": 0.015, "mutate_rate": 0.2}
VARIED |= {"mutate_power": 0.15} | LIMITS
FIXED = dict.fromkeys(VARIED, 0.0) | {"init_mean": 1.0} | LIMITS
GENES = {"bias": VARIED, "weight": VARIED, "response": FIXED}


class NeatPython:
    """A population of neat-python's that advances by generations."""

    def __init__(self, peer: Any, size: int, hidden: int) -> None:
        with tempfile.NamedTemporaryFile("w", suffix=".cfg") as file:
            lines = (f"{gene}_{k} = {v}" for gene, own in GENES.items() for k, v in own.items())
            file.write(CONFIG.format(size=size, genes="\n".join(lines)))
            file.flush()
            names = ("Genome", "Reproduction", "SpeciesSet", "Stagnation")
            self.config = peer.Config(*(getattr(peer, f"Default{n}") for n in names), file.name)
        random.seed(0)
        self.population = peer.Population(self.config)
        self._grow(hidden)

    def _grow(self, hidden: int) -> None:
        """Grow as `grown` does: copy a few ancestors, then vary each copy."""
        settings, networks = self.config.genome_config, self.population.population
        ancestors = list(networks.values())[:ANCESTORS]
        for one in ancestors:
            for _ in range(2 * hidden - STEPS_APART):
                self._vary(one, settings)
        for place, one in enumerate(networks.values()):
            if place >= ANCESTORS:
                ancestor = ancestors[place % ANCESTORS]
                one.nodes = {k: gene.copy() for k, gene in ancestor.nodes.items()}
                one.connections = {k: gene.copy() for k, gene in ancestor.connections.items()}
        for one in networks.values():
            for _ in range(STEPS_APART):
                self._vary(one, settings)
        self.population.species.species.clear()
        self.population.species.speciate(self.config, networks, 0)

    def _vary(self, network: Any, settings: Any) -> None:
        if random.random() < GROWTH.add_connection:
            network.mutate_add_connection(settings)
        if random.random() < GROWTH.add_node:
            network.mutate_add_node(settings)

    def advance(self) -> float:
        """Advance by one generation; return its seconds."""
        peer, config = self.population, self.config
        for network in peer.population.values():
            network.fitness = random.random()
        start = time.perf_counter()
        peer.population = peer.reproduction.reproduce(
            config, peer.species, config.pop_size, peer.generation
        )
        peer.species.speciate(config, peer.population, peer.generation)
        seconds = time.perf_counter() - start
        peer.generation += 1
        return seconds

    def sizes(self) -> tuple[float, float, int]:
        """Return mean hidden nodes and connections, and the number of species."""
        networks = list(self.population.population.values())
        nodes = statistics.mean(len(one.nodes) for one in networks) - OUTPUTS
        connections = statistics.mean(len(one.connections) for one in networks)
        return nodes, connections, len(self.population.species.species)
