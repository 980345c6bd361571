"""Bodies in a fluid against what Stokes flow says of them."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling, fluid, world

LITERAL = {"projection": "none", "theta_feedback": 0, "forcing_iterations": 1}


@jax.jit
def swim(box, start, rest):
    return world.rollout(box, start, rest, lambda state: state.positions)[1]


def record(box, start, rest):
    """Positions at the start and after every step, in float64."""
    seen = np.concatenate([np.asarray(start.positions)[None], swim(box, start, rest)])
    return seen.astype(float)


@pytest.fixture
def turned(immerse, hold):
    """A function that leaves a passive body in a decaying sine flow, where it is still and
    its shear strongest.

    Returns how far the body turned, and the shear integrated over time.
    """

    def drift(body, dtype, *, steps=500, viscosity=0.05, speed=0.02, **form):
        box, start = immerse(body, dtype, viscosity=viscosity, limits=False, **form)
        k = 2 * np.pi / 64
        wave = speed * np.sin(k * (np.arange(64) - 32))
        u = jnp.asarray(np.stack([np.tile(wave, (64, 1)), np.zeros((64, 64))]), dtype)
        start = replace(start, populations=fluid.equilibrium(jnp.ones((64, 64), dtype), u))
        positions = record(box, start, hold(body, steps, dtype))
        decay = np.exp(-viscosity * k**2 * np.arange(steps))
        return rotation(positions), speed * k * np.sum(decay)

    return drift


def rotation(positions):
    """By how much a body turned as a whole, anticlockwise, in radians."""
    arms = positions - positions.mean(1, keepdims=True)
    a, b = arms[:-1], arms[1:]
    sine = np.sum(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], 1)
    return np.sum(np.arctan2(sine, np.sum(a * b, (1, 2))))


def stokes_displacement(positions, size, samples):
    """How far the body would go through Stokes flow by the shapes that it went through.

    At some of the times, the forces are found that make the fluid follow the nodes but for
    a rigid motion, without net force and torque; the flow is solved spectrally, with the
    same delta. Viscosity does not matter.
    """
    every = (len(positions) - 1) // samples
    velocities = []
    for t in range(0, len(positions) - 1, every):
        x, change = positions[t], positions[t + 1] - positions[t]
        nodes, arm = len(x), x - x.mean(0)
        one, none = np.ones(nodes), np.zeros(nodes)
        rigid = np.block([[one, none], [none, one], [-arm[:, 1], arm[:, 0]]]).T
        system = np.block([[mobility(x, size), -rigid], [rigid.T, np.zeros((3, 3))]])
        known = np.concatenate([change[:, 0], change[:, 1], np.zeros(3)])
        motion = np.linalg.solve(system, known)[-3:]
        velocities.append(change.mean(0) + motion[:2])
    return every * np.sum(velocities, 0)


def mobility(positions, size):
    """Velocities at nodes by forces there, x before y, for a viscosity of 1."""
    at = coupling.windows(jnp.asarray(positions), size)
    nodes = len(positions)
    deltas = np.zeros((nodes, size[0] * size[1]))
    for node, (cells, weights) in enumerate(zip(at.cells, at.weights, strict=True)):
        np.add.at(deltas[node], np.asarray(cells), np.asarray(weights))
    kx, ky = (2 * np.pi * np.fft.fftfreq(n) for n in size)
    k = np.stack(np.meshgrid(kx, ky, indexing="ij"))
    square = np.sum(k**2, 0)
    square[0, 0] = np.inf
    waves = np.fft.fft2(deltas.reshape(nodes, *size))

    def block(i, j):
        tensor = ((i == j) - k[i] * k[j] / square) / square
        flows = np.fft.ifft2(waves * tensor).real
        return deltas @ flows.reshape(nodes, -1).T

    return np.block([[block(i, j) for j in range(2)] for i in range(2)])


def mean_path(positions):
    """How far a node travels on its way, on average."""
    moves = np.diff(positions, axis=0)
    return np.mean(np.sum(np.hypot(moves[..., 0], moves[..., 1]), 0))


def displacement(positions):
    return positions[-1].mean(0) - positions[0].mean(0)


def test_a_ring_turns_with_half_of_the_shear(turned, ring, dtype):
    angle, shear = turned(ring(28), dtype)
    np.testing.assert_allclose(angle, -shear / 2, rtol=0.05)


def test_a_ring_in_the_literal_form_does_not_turn(turned, ring, float64):
    angle, shear = turned(ring(28), float64, theta_feedback=0, projection="none")
    assert abs(angle) <= 1e-4 * shear


def test_a_rod_across_a_shear_turns_like_a_slender_one(turned, chain, dtype):
    upright = replace(chain(12), positions=chain(12).positions[:, ::-1].copy())
    angle, shear = turned(upright, dtype)
    np.testing.assert_allclose(angle, -np.arctan(shear), rtol=0.05)


@pytest.mark.parametrize(("viscosity", "period"), [(0.5, 500), (0.5, 2000), (2.0, 2000)])
def test_a_worm_swims_as_fast_as_in_stokes_flow(viscosity, period, immerse, chain, worm):
    body, dtype = chain(32), jnp.dtype("float32")
    box, start = immerse(body, dtype, viscosity=viscosity, limits=False)
    cycle = record(box, start, worm(body, dtype, period=period, periods=2))[-period - 1 :]
    with jax.enable_x64(True):
        expected = stokes_displacement(cycle, (64, 64), samples=50)
    print(f"cells in a cycle: {displacement(cycle)[0]:.3f}, in Stokes flow {expected[0]:.3f}")
    np.testing.assert_allclose(displacement(cycle)[0], expected[0], rtol=0.05)


def test_reciprocal_motion_leads_nowhere_but_in_the_literal_form(
    immerse, chain, reciprocal, dtype
):
    body, shares = chain(31), {}
    for name, form in (("force+torque", {}), ("literal", LITERAL)):
        box, start = immerse(body, dtype, viscosity=2.0, **form)
        cycle = record(box, start, reciprocal(body, dtype, period=400, periods=2))[-401:]
        shares[name] = float(np.hypot(*displacement(cycle)) / mean_path(cycle))
    print(f"displacement over path in a cycle: {shares}")
    assert shares["force+torque"] <= 0.015
    assert shares["literal"] >= 5 * shares["force+torque"]
