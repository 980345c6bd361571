"""Steady flows satisfy the equations that they are solutions of."""

import numpy as np
import pytest

from microcosmos import fluid

SIZE, SPEED, VISCOSITY = (96, 64), 0.02, 0.1

FLOWS = {
    "shear": lambda: fluid.shear(SIZE, SPEED, VISCOSITY),
    "vortices": lambda: fluid.vortices(SIZE, SPEED, VISCOSITY, 2),
    "many vortices": lambda: fluid.vortices(SIZE, SPEED, VISCOSITY, 4),
}


def slope(field, axis):
    """Return the derivative of a smooth periodic field, by its Fourier series."""
    k = 2j * np.pi * np.fft.fftfreq(field.shape[axis])
    k = k[:, None] if axis == 0 else k[None]
    return np.fft.ifft(k * np.fft.fft(field, axis=axis), axis=axis).real


@pytest.mark.parametrize("name", FLOWS)
def test_force_and_pressure_balance_viscosity_and_inertia(name):
    flow = FLOWS[name]()
    u = flow.velocity
    gradient = np.array([[slope(v, axis) for axis in (0, 1)] for v in u])
    inertia = np.einsum("jxy,ijxy->ixy", u, gradient)
    pressure = np.stack([slope(flow.density / 3, axis) for axis in (0, 1)])
    friction = VISCOSITY * np.stack([slope(slope(v, 0), 0) + slope(slope(v, 1), 1) for v in u])
    np.testing.assert_allclose(inertia + pressure, friction + flow.force, atol=1e-12)
    np.testing.assert_allclose(gradient[0, 0] + gradient[1, 1], 0, atol=1e-12)
    strain = gradient[0, 0], gradient[1, 1], 0.5 * (gradient[0, 1] + gradient[1, 0])
    np.testing.assert_allclose(flow.strain, strain, atol=1e-12)
    np.testing.assert_allclose(np.hypot(*u).max(), SPEED, rtol=1e-2)


def test_poiseuille_flow_vanishes_at_its_walls_and_is_fastest_in_the_middle():
    flow = fluid.poiseuille((8, 33), SPEED, VISCOSITY)
    u = flow.velocity[0, 0]
    np.testing.assert_allclose(np.diff(u[1:], 2), -flow.force[0] / VISCOSITY)
    roots = np.roots(np.polyfit(np.arange(1, 33), u[1:], 2))
    np.testing.assert_allclose(np.sort(roots), [0.5, 32.5])
    assert u.argmax() in (16, 17)
    np.testing.assert_allclose(u.max(), SPEED, rtol=2e-3)


def test_a_developed_fluid_moves_as_its_flow():
    flow = FLOWS["vortices"]()
    f = fluid.developed(flow, VISCOSITY)
    momentum = np.stack(fluid.momentum(f)) + 0.5 * flow.force
    np.testing.assert_allclose(fluid.density(f), flow.density, rtol=1e-5)
    np.testing.assert_allclose(momentum / flow.density, flow.velocity, atol=1e-7)
