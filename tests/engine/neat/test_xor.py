"""NEAT finds networks for XOR, which none without a hidden node is."""

import importlib
from pathlib import Path

import jax
import jax.numpy as jnp
import pytest

pytestmark = pytest.mark.long

BENCHMARKS = Path(__file__).parents[3] / "engine" / "benchmarks"


def test_xor_is_solved_with_hidden_nodes_only(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    solve = importlib.import_module("xor").solve
    keys = jax.vmap(jax.random.key)(jnp.arange(6))
    solved, generations, hidden = jax.jit(lambda k: jax.lax.map(solve, k))(keys)
    assert jnp.sum(solved) >= 4, f"stopped after {generations} generations"
    assert (hidden[solved] >= 1).all()
