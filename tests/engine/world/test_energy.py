"""What nodes collect of the energy field, and what is left."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, coupling, fields, world
from validation import scenes

SIZE, STEPS = (32, 32), 80


@pytest.fixture
def forager(float64):
    """A function that makes a world with packets, its start and the shapes of a swimmer."""

    def make(layers=1, rate=None, diffusion=None):
        body = bodies.chain(12, 1.0)
        packets = fields.packets(SIZE, fields.Packets(6, 3.0, 0.5, 2))
        energy = fields.Energy(
            jnp.asarray(packets),
            None if diffusion is None else jnp.asarray(diffusion),
            None if rate is None else jnp.asarray(rate),
        )
        form = world.Form(layers=layers)
        box, start = scenes.immersed(body, 0.1, float64, size=SIZE, form=form, energy=energy)
        wave = np.sin(np.arange(STEPS)[:, None] / 12 - np.arange(10)[None] / 3)
        return box, start, scenes.rest(body, 0.2 * wave, float64)

    return make


def watched(box, start, rest):
    """The end, and positions, sums of the field and of what was collected after every step."""
    return jax.jit(world.rollout, static_argnums=3)(box, start, rest, totals)


def totals(state, _):
    return state.positions, jnp.sum(state.energy), jnp.sum(state.collected)


def interpolated(plane, positions):
    """The plane at positions with Peskin's delta, written out over all cells."""
    weights = []
    for axis, side in enumerate(SIZE):
        away = np.arange(side)[None] - positions[:, axis, None]
        weights.append(coupling.peskin(jnp.asarray(away - side * np.round(away / side))))
    return np.einsum("px,py,xy->p", *weights, plane)


def test_of_a_lasting_field_nodes_collect_the_sum_over_steps(forager):
    box, start, rest = forager()
    end, (positions, left, _) = watched(box, start, rest)
    places = np.concatenate([start.positions[None], positions[:-1]])
    plane = np.asarray(start.energy)
    expected = sum(interpolated(plane, x) for x in places)
    assert np.asarray(end.collected).std() > 0.1
    np.testing.assert_allclose(end.collected, expected, rtol=1e-11)
    np.testing.assert_allclose(left, plane.sum(), rtol=1e-14)


@pytest.mark.parametrize(
    ("layers", "rate", "diffusion"), [(1, 0.1, None), (2, 1.0, None), (2, 0.3, 0.2)]
)
def test_what_is_collected_is_gone(layers, rate, diffusion, forager):
    box, start, rest = forager(layers, rate, diffusion)
    end, (_, left, collected) = watched(box, start, rest)
    before = float(start.energy.sum())
    assert float(collected[-1]) > 0.02 * before
    np.testing.assert_allclose(left + collected, before, rtol=1e-12)
    assert np.all(np.diff(collected) >= 0)
    assert float(end.energy.min()) >= -1e-15


def test_diffusion_in_a_world_keeps_the_sum(forager):
    box, start, rest = forager(diffusion=0.25)
    end, (_, left, _) = watched(box, start, rest)
    np.testing.assert_allclose(left, start.energy.sum(), rtol=1e-12)
    assert float(end.energy.max()) < 0.9 * float(start.energy.max())


def test_nodes_sense_the_field_where_they_are(forager):
    box, start, _ = forager()
    expected = interpolated(np.asarray(start.energy), np.asarray(start.positions))
    np.testing.assert_allclose(world.sense(box, start), expected, rtol=1e-12)


def test_without_a_field_nothing_is_sensed_or_collected(float64):
    box, start = scenes.immersed(bodies.chain(12, 1.0), 0.1, float64, size=SIZE)
    np.testing.assert_array_equal(world.sense(box, start), np.zeros(12))
    rest = jax.tree.map(lambda x: x[0], scenes.held(bodies.chain(12, 1.0), 1, float64))
    assert jax.jit(world.step)(box, start, rest)[0].collected is None
