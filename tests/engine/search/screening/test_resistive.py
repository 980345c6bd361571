"""Resistive force theory beside its closed forms."""

import jax
import numpy as np
import pytest

from microcosmos.search import screening
from microcosmos.search.screening import PHASES

swim = jax.jit(screening.swim)
NODES = 121


def travelling_wave(amplitude, waves):
    """A wave of small amplitude that travels along a filament of length 1, towards +x."""
    x = np.linspace(0, 1, NODES)
    phase = 2 * np.pi * np.arange(PHASES) / PHASES
    y = amplitude * np.sin(2 * np.pi * waves * x[None] - phase[:, None])
    return np.stack(np.broadcast_arrays(x[None], y), 2)


def test_a_small_wave_swims_at_the_speed_of_gray_and_hancock(chain_stroke, edges):
    """For y = A sin(kx − ωt) of small amplitude, U / c = −A²k² (ζ − 1) / 2 with c = ω / k and a
    drag across ζ = 2 times that along (Lauga and Powers 2009, section 5.2)."""
    amplitude, waves, took = 2e-3, 6, 10.0
    stroke = chain_stroke(travelling_wave(amplitude, waves), took)
    moved = swim(stroke, edges(NODES), np.ones(NODES - 1))
    k = 2 * np.pi * waves
    speed = (2 * np.pi / (PHASES * took)) / k * amplitude**2 * k**2 / 2
    expected = speed * PHASES * took
    assert float(moved.displacement[0]) == pytest.approx(-expected, rel=0.05)
    assert abs(float(moved.displacement[1])) < 0.05 * expected


def test_a_reciprocal_stroke_goes_nowhere(chain_stroke, edges):
    """The scallop theorem (Purcell, Am. J. Phys. 45, 3 (1977))."""
    bend = 0.3 * np.sin(2 * np.pi * np.arange(PHASES) / PHASES)
    x = np.linspace(-1, 1, NODES)
    positions = np.stack(np.broadcast_arrays(x[None], bend[:, None] * x[None] ** 2), 2)
    moved = swim(chain_stroke(positions, 5.0), edges(NODES), np.ones(NODES - 1))
    size = np.abs(np.asarray(moved.velocity)).max() * 5.0
    assert np.hypot(*np.asarray(moved.displacement)) < 1e-3 * size
    assert abs(float(moved.turn)) < 1e-5


def test_no_force_and_no_torque_act_on_the_body(chain_stroke, edges):
    rng = np.random.default_rng(0)
    angles = np.cumsum(0.3 * rng.normal(size=(PHASES, 20)), 1)
    steps = np.stack([np.cos(angles), np.sin(angles)], 2)
    positions = np.concatenate([np.zeros((PHASES, 1, 2)), np.cumsum(steps, 1)], 1)
    stroke = chain_stroke(positions, 3.0)
    moved = swim(stroke, edges(21), np.ones(20))
    shapes, velocity = np.asarray(stroke.shapes, float), np.asarray(moved.velocity, float)
    begin, end = shapes[:, :-1], shapes[:, 1:]
    length = np.linalg.norm(end - begin, axis=2, keepdims=True)
    tangent, v = (end - begin) / length, (velocity[:, :-1] + velocity[:, 1:]) / 2
    along = np.sum(tangent * v, 2, keepdims=True)
    force = length * (2 * v - tangent * along)
    arm = (begin + end) / 2
    torque = arm[..., 0] * force[..., 1] - arm[..., 1] * force[..., 0]
    scale = np.abs(force).sum((1, 2))
    assert np.abs(force.sum(1)).max() < 1e-4 * scale.max()
    assert np.abs(torque.sum(1)).max() < 1e-3 * scale.max()
    power = np.sum(force * v, (1, 2))
    np.testing.assert_allclose(moved.power, power, rtol=1e-3)
