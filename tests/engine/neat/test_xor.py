"""NEAT finds networks for XOR, which none without a hidden node is."""

import runpy
from pathlib import Path

import jax

SOURCE = Path(__file__).parents[3] / "engine" / "benchmarks" / "neat.py"


def test_xor_is_solved_with_hidden_nodes_only():
    program = jax.jit(runpy.run_path(str(SOURCE))["solve"])
    for seed in range(3):
        solved, generations, hidden = program(jax.random.key(seed))
        assert solved, f"not in {generations} generations"
        assert hidden >= 1
