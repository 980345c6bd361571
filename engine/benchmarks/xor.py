"""XOR by NEAT as in the paper that brought it: how often, and after how many evaluations.

Stanley and Miikkulainen, Evolutionary Computation 10, 99 (2002), section 4.1. Prints a table
and asserts nothing; an argument says how many seeds.
"""

import sys
from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import device, genomes, neat

XOR = neat.PRESETS["paper"]
INPUTS, CORNERS, EXPECTED = 2, ((0, 0, 1, 1), (0, 1, 0, 1)), (0, 1, 1, 0)
"""Nodes have biases of their own; the paper has a third input that is always 1."""
ROOM = (16, 40)
STEEPNESS = 4.9
"""Slope of the paper's sigmoid; here weights and biases are multiplied by it."""
GENERATIONS = 90
"""As many as the paper's slowest run took."""
FIRST_SEED = 1000
"""Settings were chosen with smaller ones."""


def main() -> None:
    device.prepare()
    xor(int(sys.argv[1]) if len(sys.argv) > 1 else 100)


def xor(seeds: int) -> None:
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
    """Success, generations evaluated, and hidden nodes of the solution."""
    step = partial(neat.next_generation, settings=XOR, inputs=INPUTS, outputs=1, key=key)
    networks = jax.vmap(beginner)(jax.random.split(key, XOR.population))
    start = (
        networks,
        neat.first_species(networks, XOR),
        neat.first_counters(INPUTS, 1),
        jnp.asarray(0),
        jnp.asarray(False),
        jnp.asarray(0),
    )

    def advance(state):
        networks, species, counters, generation, _, _ = state
        fitness, right = jax.vmap(judge)(networks)
        hidden = jnp.sum(networks.node_used[jnp.argmax(right)]) - INPUTS - 1
        after = step(networks, fitness, species, counters, generation=generation)
        return (*after[:3], generation + 1, jnp.any(right), hidden)

    end = jax.lax.while_loop(lambda s: ~s[4] & (s[3] < GENERATIONS), advance, start)
    return end[4], end[3], end[5]


def beginner(key: jax.Array) -> genomes.CPPN:
    """A minimal network of sigmoids."""
    return neat.minimal(key, INPUTS, 1, *ROOM, XOR.rates.palette)


def judge(network: genomes.CPPN) -> tuple[jax.Array, jax.Array]:
    """The paper's fitness, (4 − Σ|error|)², and whether all four answers are right."""
    steep = replace(network, weight=STEEPNESS * network.weight, bias=STEEPNESS * network.bias)
    out = genomes.evaluate(steep, jnp.float32(CORNERS), 1)[0]
    expected = jnp.float32(EXPECTED)
    error = jnp.sum(jnp.abs(out - expected))
    return (4 - error) ** 2, jnp.all((out > 0.5) == (expected > 0.5))


if __name__ == "__main__":
    main()
