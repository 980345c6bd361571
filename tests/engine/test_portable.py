"""Arithmetic of searches: near enough, with slopes, and the same for all instruction sets."""

import os
import platform
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import portable

PROGRAM = """
import hashlib
import jax
import jax.numpy as jnp
from microcosmos import portable
x = jax.random.normal(jax.random.key(0), (101, 90)) * jnp.logspace(-3, 5, 90)[None]
y = jnp.roll(x, 17, 1)
programs = (
    portable.sine, portable.cosine, jnp.exp, jnp.tanh, jax.nn.sigmoid,
    lambda x: portable.arctangent(x, y), lambda x: portable.power(0.3, jnp.abs(x)),
    lambda x: portable.product(x.T, y), lambda x: portable.long_product(x.T, y),
    lambda x: 1 / portable.root(jnp.abs(x)),
    lambda x: jnp.log(jnp.abs(x)), lambda x: jax.lax.erf_inv(jnp.tanh(x)),
    lambda x: jnp.sum(x * y, 1) + jnp.std(x, 1), lambda x: jnp.cumsum(x * y, 1),
)
for program in programs:
    print(hashlib.sha256(jax.jit(program)(x).tobytes()).hexdigest())
"""


@pytest.mark.parametrize("size", [1.0, 100.0, 1e6])
def test_sine_and_cosine_are_right_to_single_precision(size):
    x = np.linspace(-size, size, 20_001, dtype=np.float32)
    exact = x.astype(float)
    np.testing.assert_allclose(portable.sine(x), np.sin(exact), rtol=0, atol=1.5e-7)
    np.testing.assert_allclose(portable.cosine(x), np.cos(exact), rtol=0, atol=1.5e-7)


def test_no_angle_has_neither_sine_nor_cosine():
    none = jnp.asarray([jnp.inf, -jnp.inf, jnp.nan], jnp.float32)
    assert np.all(np.isnan(portable.sine(none)) & np.isnan(portable.cosine(none)))
    assert np.all(np.abs(portable.sine(jnp.asarray([3e38, -1e30], jnp.float32))) <= 1)


def test_arctangents_are_right_in_all_quarters():
    parts = np.array([0.0, -0.0, 1e-6, 0.3, -0.3, 1, -1, 5e4], np.float32)
    y, x = (one.ravel() for one in np.meshgrid(parts, parts))
    np.testing.assert_allclose(portable.arctangent(y, x), np.arctan2(y, x), rtol=3e-7)


def test_powers_are_those_of_python():
    exponent = np.array([0.0, 0.5, 1.0, 20.0], np.float32)
    for base in (0.0, 0.2, 1.0, 3.0):
        np.testing.assert_allclose(portable.power(base, exponent), base**exponent, rtol=2e-5)


def test_functions_have_their_slopes(require_slope, float64):
    x = jnp.linspace(-4, 4, 9, dtype=float64)
    require_slope(lambda x: jnp.sum(portable.sine(x) + x * portable.cosine(x)), x, rtol=1e-7)
    require_slope(lambda x: jnp.sum(portable.arctangent(x, 1 + x * x)), x, rtol=1e-7)
    single = x.astype(jnp.float32)
    slopes = jax.vmap(jax.grad(portable.sine))(single)
    np.testing.assert_array_equal(slopes, portable.cosine(single))


@pytest.mark.long
@pytest.mark.skipif(platform.machine() != "x86_64", reason="not x86-64")
def test_instruction_sets_give_the_same_bits():
    def digests(instruction_set):
        flags = f"--xla_cpu_max_isa={instruction_set} --xla_cpu_experimental_ynn_fusion_type="
        chosen = os.environ | {"XLA_FLAGS": flags, "JAX_PLATFORMS": "cpu"}
        chosen.pop("JAX_COMPILATION_CACHE_DIR", None)
        return subprocess.check_output([sys.executable, "-c", PROGRAM], text=True, env=chosen)

    assert digests("SSE4_2") == digests("AVX")
