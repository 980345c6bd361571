"""The fluid against flows that are known in closed form."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import fluid

VISCOUS_TIMES = 5


def error(u, exact):
    """Relative L2 distance of two fields."""
    u, exact = np.asarray(u, float), np.asarray(exact, float)
    return np.sqrt(np.sum((u - exact) ** 2) / np.sum(exact**2))


def advance(f, force, rates, steps):
    def step(_, f):
        return fluid.stream(fluid.collide(f, fluid.density(f), fluid.momentum(f), force, rates))

    f = jax.jit(lambda f: jax.lax.fori_loop(0, steps, step, f))(f)
    return (jnp.stack(fluid.momentum(f)) + 0.5 * force) / fluid.density(f)[None]


def kolmogorov_error(tau, magic, dtype):
    """Distance from the steady flow under a sine force, started on it.

    The flow is the same along x, so that a box two cells wide is as good as a square.
    """
    size, k = (2, 64), 2 * np.pi / 64
    viscosity = (tau - 0.5) / 3
    wave = np.broadcast_to(np.sin(k * np.arange(64)), size)
    exact = jnp.asarray(np.stack([0.01 * wave, 0 * wave]), dtype)
    force = viscosity * k**2 * exact
    f = fluid.equilibrium(jnp.ones(size, dtype), exact)
    # At large τ the start without viscous stress decays more slowly than the flow.
    steps = 2000 + round(VISCOUS_TIMES / (viscosity * k**2))
    rates = fluid.rates(jnp.asarray(viscosity, dtype), magic)
    return error(advance(f, force, rates, steps), exact)


def taylor_green_error(n, tau, magic, dtype, speed=0.01):
    """Distance from decaying vortices, started with their pressure field."""
    k, viscosity = 2 * np.pi / n, (tau - 0.5) / 3
    x, y = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    u = np.stack([-np.cos(k * x) * np.sin(k * y), np.sin(k * x) * np.cos(k * y)]) * speed
    rho = 1 - 0.75 * speed**2 * (np.cos(2 * k * x) + np.cos(2 * k * y))
    f = fluid.equilibrium(jnp.asarray(rho, dtype), jnp.asarray(u, dtype))
    steps = round(1 / (4 * viscosity * k**2))
    rates = fluid.rates(jnp.asarray(viscosity, dtype), magic)
    end = advance(f, jnp.zeros((2, n, n), dtype), rates, steps)
    return error(end, u * np.exp(-2 * viscosity * k**2 * steps))


@pytest.mark.parametrize("tau", [0.53, 0.6, 0.8, 1.0, 2.0, 6.5])
def test_kolmogorov_flow_is_exact_to_a_thousandth_at_any_viscosity(tau, dtype):
    assert kolmogorov_error(tau, fluid.fixed_magic, dtype) <= 1e-3


@pytest.mark.parametrize("tau", [0.53, 0.6, 0.8])
def test_kolmogorov_flow_is_exact_to_two_thousandths_with_the_cap(tau, dtype):
    assert kolmogorov_error(tau, fluid.capped_magic, dtype) <= 2e-3


@pytest.mark.parametrize("tau", [0.53, 0.6, 0.8, 1.0])
def test_taylor_green_vortices_decay_at_the_viscous_rate(tau, dtype):
    assert taylor_green_error(64, tau, fluid.fixed_magic, dtype) <= 1.5e-3


@pytest.mark.parametrize("tau", [0.53, 0.6, 0.8])
def test_taylor_green_vortices_decay_at_the_viscous_rate_with_the_cap(tau, dtype):
    assert taylor_green_error(64, tau, fluid.capped_magic, dtype) <= 2e-3


def test_the_error_falls_with_the_square_of_the_resolution(dtype):
    # The Mach number falls with the cell size, else its error would remain.
    errors = [
        taylor_green_error(n, 0.8, fluid.fixed_magic, dtype, speed=0.64 / n)
        for n in (16, 32, 64)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders >= 1.9), f"errors {errors}, orders {orders}"
