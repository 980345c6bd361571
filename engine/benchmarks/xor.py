"""XOR by NEAT as in the original paper: success rate, and evaluations until the solution.

Stanley and Miikkulainen, Evolutionary Computation 10, 99 (2002), section 4.1. Prints a table
and asserts nothing; an argument is the number of seeds.
"""

import sys
from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import timing

from microcosmos import device, genomes, neat

XOR = neat.PRESETS["paper"]
INPUTS, CORNERS, EXPECTED = 2, ((0, 0, 1, 1), (0, 1, 0, 1)), (0, 1, 1, 0)
"""Nodes have biases of their own; the paper has a third input that is always 1."""
ROOM = (16, 40)
STEEPNESS = 4.9
"""Slope of the paper's sigmoid; here weights and biases are multiplied by it."""
GENERATIONS = 90
"""The generations of the paper's slowest run."""
FIRST_SEED = 1000
"""Smaller seeds were used to choose the settings."""


def main() -> None:
    device.prepare()
    xor(int(sys.argv[1]) if len(sys.argv) > 1 else 100)


def xor(seeds: int) -> None:
    keys = jax.vmap(jax.random.key)(FIRST_SEED + jnp.arange(seeds))
    results = np.stack(jax.device_get(jax.jit(partial(jax.lax.map, solve))(keys)), 1)
    done = results[:, 0] > 0
    evaluations, hidden = XOR.population * results[done, 1], results[done, 2].mean()
    figures = (np.median(evaluations), evaluations.mean(), evaluations.max())
    rows = [
        ("ours", *(f"{figure:,.0f}" for figure in figures), f"{hidden:.2f}"),
        ("paper, 100 runs", "–", "4,755", "13,459", "2.35"),
    ]
    title = f"XOR: solved with {done.sum()} of {seeds} seeds in {GENERATIONS} generations"
    columns = ("evaluations", "median", "mean", "worst", "hidden nodes")
    timing.print_table(title, columns, rows)


def solve(key: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Return success, generations evaluated, and hidden nodes of the solution."""
    step = partial(neat.next_generation, settings=XOR, inputs=INPUTS, outputs=1, key=key)
    minimal = jax.vmap(lambda k: neat.minimal(k, INPUTS, 1, *ROOM, XOR.rates.palette))
    networks = minimal(jax.random.split(key, XOR.population))
    species, counters = neat.first_species(networks, XOR), neat.first_counters(INPUTS, 1)
    zero = jnp.asarray(0)
    start = (networks, species, counters, zero, jnp.asarray(False), zero)

    def advance(state):
        networks, species, counters, generation, _, _ = state
        fitness, right = jax.vmap(score)(networks)
        hidden = jnp.sum(networks.node_used[jnp.argmax(right)]) - INPUTS - 1
        after = step(networks, fitness, species, counters, generation=generation)
        return (*after[:3], generation + 1, jnp.any(right), hidden)

    end = jax.lax.while_loop(lambda s: ~s[4] & (s[3] < GENERATIONS), advance, start)
    return end[4], end[3], end[5]


def score(network: genomes.CPPN) -> tuple[jax.Array, jax.Array]:
    """Return the paper's fitness, (4 − Σ|error|)², and if all four outputs are right."""
    steep = replace(network, weight=STEEPNESS * network.weight, bias=STEEPNESS * network.bias)
    out = genomes.evaluate(steep, jnp.float32(CORNERS), 1)[0]
    expected = jnp.float32(EXPECTED)
    error = jnp.sum(jnp.abs(out - expected))
    return (4 - error) ** 2, jnp.all((out > 0.5) == (expected > 0.5))


if __name__ == "__main__":
    main()
