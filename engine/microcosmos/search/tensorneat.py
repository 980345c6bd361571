"""TensorNEAT's own NEAT (Wang et al., arXiv:2404.01817) as an optional backend.

Only this file imports it, and only to run it: it is under the GPL, version 3.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from ..genomes import ACTIVATIONS, CPPN
from ..neat import Settings
from .tensorneat_genomes import cppns

State = Any
"""TensorNEAT's: a pytree of arrays by name, one of them (`species`) such a state itself."""


def available() -> bool:
    """Return whether the package can be imported."""
    return find_spec("tensorneat") is not None


@dataclass(frozen=True)
class Backend:
    """An ask-tell loop of TensorNEAT; `build` makes one."""

    algorithm: Any
    next_state: Callable[[State, Array], State]
    meta: Mapping[str, Any]
    """Names for its genomes, for `viz.networks.read_tensorneat`."""

    def setup(self, seed: int) -> State:
        """Return the first population."""
        key = import_module("tensorneat.common").State(randkey=jax.random.PRNGKey(seed))
        # Names in another order would compile the program again.
        return self.from_arrays(self.to_arrays(self.algorithm.setup(key)))

    def ask(self, state: State) -> tuple[np.ndarray, np.ndarray]:
        """Return the genomes to measure: nodes and connections, (individual, row, column)."""
        nodes, connections = self.algorithm.ask(state)
        return np.asarray(nodes), np.asarray(connections)

    def tell(self, state: State, fitness: Float[np.ndarray, "individual"]) -> State:
        """Return the next population; a NaN fitness counts as worst."""
        values = np.asarray(fitness, np.float32)
        return self.next_state(state, jnp.asarray(np.where(np.isnan(values), -np.inf, values)))

    def to_arrays(self, state: State) -> dict[str, np.ndarray]:
        """Return all arrays of a state by name; those of its species as `species.*`."""
        return _flat(state, "")

    def from_arrays(self, arrays: Mapping[str, np.ndarray | Array]) -> State:
        """Return the state of such arrays, bit for bit."""
        states = import_module("tensorneat.common")
        named = {name: jnp.asarray(arrays[name]) for name in sorted(arrays)}
        plain = {name: x for name, x in named.items() if "." not in name}
        species = {name.split(".")[1]: x for name, x in named.items() if "." in name}
        return states.State(**plain, species=states.State(**species))

    def population(self, state: State) -> tuple[CPPN, Bool[np.ndarray, "individual"]]:
        """Return the genomes as our networks, and which compute every output; see `cppns`."""
        nodes, connections = self.ask(state)
        names, ends = self.meta["activation_names"], ("num_inputs", "num_outputs")
        return cppns(nodes, connections, names, *(self.meta[end] for end in ends))


def build(
    settings: Settings, inputs: int, outputs: int, max_nodes: int, max_connections: int
) -> Backend:
    """Build TensorNEAT with those of our settings that it has; it allots offspring by rank.

    Raises `ValueError` if it is not installed, or cannot follow the settings.
    """
    if not available():
        raise ValueError(
            "`neat.backend` tensorneat needs the package tensorneat (GPL-3), which is not "
            "installed; install it with: make tensorneat"
        )
    if settings.rates.recurrent:
        raise ValueError("`neat.backend` tensorneat needs feed-forward networks, got recurrent")
    names = tuple(ACTIVATIONS)
    activations = [names[place] for place in settings.rates.palette]
    genome = _genome(settings, inputs, outputs, max_nodes, max_connections, activations)
    algorithm = import_module("tensorneat.algorithm").NEAT(
        genome,
        pop_size=settings.population,
        species_size=settings.max_species,
        max_stagnation=settings.stagnation,
        species_elitism=settings.species_elitism,
        spawn_number_change_rate=1 - settings.inertia,
        genome_elitism=settings.elites,
        survival_threshold=settings.survival,
        min_species_size=settings.min_size,
        compatibility_threshold=settings.threshold,
    )
    meta = {
        "genome_class": "DefaultGenome",
        "node_class": "BiasNode",
        "conn_class": "DefaultConn",
        "activation_names": activations,
        "aggregation_names": ["sum"],
        "num_inputs": inputs,
        "num_outputs": outputs,
    }
    return Backend(algorithm, jax.jit(algorithm.tell), meta)


def _genome(
    settings: Settings,
    inputs: int,
    outputs: int,
    max_nodes: int,
    max_connections: int,
    activations: list[str],
) -> Any:
    kinds = import_module("tensorneat.genome")
    rates, coefficients = settings.rates, settings.coefficients
    bound = float("inf") if rates.bound is None else rates.bound
    node = kinds.BiasNode(
        bias_mutate_power=rates.weight_step,
        bias_mutate_rate=rates.weight,
        bias_replace_rate=rates.replace,
        bias_lower_bound=-bound,
        bias_upper_bound=bound,
        activation_options=[_function(name) for name in activations],
        activation_replace_rate=rates.activation,
    )
    connection = kinds.DefaultConn(
        weight_mutate_power=rates.weight_step,
        weight_mutate_rate=rates.weight,
        weight_replace_rate=rates.replace,
        weight_lower_bound=-bound,
        weight_upper_bound=bound,
    )
    mutation = kinds.DefaultMutation(
        conn_add=rates.add_connection,
        conn_delete=rates.delete_connection,
        node_add=rates.add_node,
        node_delete=rates.delete_node,
    )
    distance = kinds.DefaultDistance(coefficients.disjoint, coefficients.weight)
    return kinds.DefaultGenome(
        inputs,
        outputs,
        max_nodes,
        max_connections,
        node_gene=node,
        conn_gene=connection,
        mutation=mutation,
        distance=distance,
    )


def _function(name: str) -> Callable:
    """Return TensorNEAT's function of that name; register ours if it has none."""
    known = import_module("tensorneat.common").ACT
    if name not in known.name2jnp:
        known.add_func(name, ACTIVATIONS[name])
    return getattr(known, name)


def _flat(state: State, prefix: str) -> dict[str, np.ndarray]:
    arrays = {}
    for name in sorted(state.registered_keys()):
        value = getattr(state, name)
        nested = hasattr(value, "registered_keys")
        arrays |= _flat(value, f"{name}.") if nested else {prefix + name: np.asarray(value)}
    return arrays
