"""Several bodies in one world, and the energy that nodes collect."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, coupling, fields, fluid, world
from microcosmos.bodies import swimmers
from microcosmos.device import array
from validation import scenes

repel = jax.jit(world.repel)
weight = jax.jit(coupling.ROMA.weight)
BOTH = pytest.mark.parametrize("gradient", [fields.gaussian, fields.binomial])


@jax.jit
def watch(box, start, rest):
    """The end, with positions and forces of each body after every step."""
    return world.rollout(box, start, rest, lambda s, m: (s.positions, m.force))


def wild_and_calm(dtype):
    """Rest shapes of two bodies of which only the first is asked to move."""
    body = scenes.parallel_chains(16, 20.0)
    rest = scenes.erratic(body, 60, dtype, seed=0)
    still = scenes.held(body, 60, dtype)
    angle, length = np.array(rest.angle), np.array(rest.length)
    angle[:, 14:], length[:, 15:] = still.angle[:, 14:], still.length[:, 15:]
    return body, type(rest)(array(angle), array(length))


@pytest.mark.long
def test_each_body_exerts_no_force_however_they_move(float64):
    body, options = scenes.parallel_chains(16, 3.0), {"form": world.Form(layers=2)}
    options |= {"steric": scenes.steric(4.0, float64), "limits": scenes.limits(0.1, float64)}
    box, start = scenes.immersed(body, 0.1, float64, size=(32, 32), **options)
    end, (_, force) = watch(box, start, scenes.erratic(body, 60, float64, seed=1))
    assert force.shape == (60, 2, 2)
    np.testing.assert_allclose(force, 0, atol=1e-13)
    drift = [np.sum(plane) for plane in jax.jit(fluid.momentum)(end.populations)]
    np.testing.assert_allclose(drift, 0, atol=1e-11)
    assert np.abs(np.asarray(end.positions) - start.positions).max() > 0.5


@pytest.mark.long
def test_another_body_is_moved_only_by_the_fluid(float64):
    body, rest = wild_and_calm(float64)
    options = {"size": (48, 48), "limits": scenes.limits(0.1, float64)}
    box, start = scenes.immersed(body, 0.1, float64, **options)
    alone, _ = scenes.immersed(bodies.chain(16, 1.0), 0.1, float64, **options)
    begun = jax.jit(world.at_rest)(alone, np.asarray(start.positions)[:16])
    _, (pair, _) = jax.device_get(watch(box, start, rest))
    bent = type(rest)(
        array(np.asarray(rest.angle)[:, :14]), array(np.asarray(rest.length)[:, :15])
    )
    _, (single, _) = jax.device_get(watch(alone, begun, bent))
    # At first the fluid around the other one is at rest, and so is it.
    np.testing.assert_allclose(pair[0, :16], single[0], atol=1e-14)
    np.testing.assert_allclose(pair[0, 16:], start.positions[16:], atol=1e-14)
    moved = np.abs(np.asarray(pair[-1, 16:] - start.positions[16:])).max()
    assert 1e-4 < moved < 1


def test_the_limit_of_force_is_each_bodys_own(float64):
    body, rest = wild_and_calm(float64)
    both = scenes.erratic(body, 1, float64, seed=0)
    limits = world.Limits(None, array(0.05))
    box, start = scenes.immersed(body, 0.1, float64, size=(48, 48), limits=limits)
    step = jax.jit(world.step)
    _, one = step(box, start, jax.tree.map(lambda x: x[0], rest))
    _, two = step(box, start, jax.tree.map(lambda x: x[0], both))
    # A body at its limit holds all of its nodes, and nobody else's.
    assert (one.held, two.held) == (0.5, 1)


@pytest.mark.parametrize(
    ("name", "gradient"), [("tadpole", fields.gaussian), ("jellyfish", fields.binomial)]
)
def test_no_body_moves_itself_by_repulsion(name, gradient, float64):
    swimmer = swimmers.SWIMMERS[name]()
    steric = scenes.steric(4.0, float64, gradient)
    box, start = scenes.immersed(swimmer.body, 0.3, float64, steric=steric)
    bent = np.asarray(start.positions) + 0.3 * np.random.default_rng(0).normal(
        size=start.positions.shape
    )
    found = repel(box, bent)
    push, drift = found.push, found.drift
    assert np.abs(push).max() > 0.05
    np.testing.assert_array_equal(drift, 0)
    np.testing.assert_allclose(np.sum(push, 0), 0, atol=1e-13)
    np.testing.assert_allclose(np.sum(cross(np.asarray(bent), np.asarray(push))), 0, atol=1e-11)


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


NODES, LEVER, GAP = 20, 7.0, 1.5


def overlapping(turned, strength, gradient, dtype):
    """Two rods of `NODES` nodes that touch with their ends, `LEVER` from their centres."""
    along = np.array([np.cos(turned), np.sin(turned)])
    apart = LEVER * along + GAP / 2 * np.array([-along[1], along[0]])
    rod = bodies.chain(NODES, 1.0)
    pair = [bodies.placed(rod, tuple(sign * apart), turned=turned) for sign in (-1, 1)]
    body, steric = bodies.combined(pair), scenes.steric(strength, dtype, gradient)
    limits = scenes.limits(0.3, dtype)
    return body, *scenes.immersed(body, 0.3, dtype, steric=steric, limits=limits)


@BOTH
@pytest.mark.parametrize("turned", [0.0, 0.3, 1.1])
def test_contact_off_the_centre_turns_rods_by_the_torque_of_the_push(gradient, turned, float64):
    _, box, start = overlapping(turned, 0.2, gradient, float64)
    drift, x = np.asarray(repel(box, start.positions).drift), np.asarray(start.positions)
    across = np.array([-np.sin(turned), np.cos(turned)])
    for rod, sign in ((slice(NODES), 1), (slice(NODES, None), -1)):
        moved, arms = drift[rod].mean(0), x[rod] - x[rod].mean(0)
        spin = np.sum(cross(arms, drift[rod])) / np.sum(arms**2)
        expected = NODES * sign * LEVER * (moved @ across) / np.sum(arms**2)
        np.testing.assert_allclose(spin, expected, rtol=0.08)
        rigid = moved + spin * np.stack([-arms[:, 1], arms[:, 0]], 1)
        np.testing.assert_allclose(drift[rod], rigid, atol=1e-14)
        assert spin < -1e-3
    # The pushes of a pair are equal and opposite, and along their line to a few per cent.
    np.testing.assert_allclose(np.sum(drift, 0), 0, atol=1e-14)
    one = NODES * cross(x[:NODES].mean(0) - 32, drift[:NODES].mean(0))
    assert abs(np.sum(cross(x - 32, drift))) <= 0.1 * abs(one)


@BOTH
def test_contact_moves_a_centre_and_turns_an_end_at_most_by_the_limit(gradient, float64):
    _, box, start = overlapping(0.0, 4.0, gradient, float64)
    drift = np.asarray(repel(box, start.positions).drift)[:NODES]
    moved = drift.mean(0)
    np.testing.assert_allclose(np.hypot(*moved), 0.1, rtol=1e-9)
    np.testing.assert_allclose(np.hypot(*(drift - moved).T).max(), 0.1, rtol=1e-9)


def driven_together(gradient, speed, dtype):
    """How far one rigid filament is ahead of another after being driven 20 cells through it."""
    one = bodies.chain(20, 1.0)
    pair = bodies.combined([bodies.placed(one, (0.0, -3.0)), bodies.placed(one, (0.4, 3.0))])
    box, start = scenes.immersed(pair, 0.3, dtype)
    if gradient is not None:
        box = replace(box, steric=scenes.steric(4.0, dtype, gradient))
    imposed = speed * np.where(np.asarray(box.groups.member) == 0, 1.0, -1.0)[:, None]
    imposed = imposed * np.asarray([[0.0, 1.0]], dtype)

    def advance(positions, _):
        drift = world.repel(box, positions).drift
        return positions + drift + imposed, None

    steps = round(10 / speed)
    drive = jax.jit(lambda start: jax.lax.scan(advance, start, None, length=steps)[0])
    end = np.asarray(drive(start.positions))
    return float(np.mean(end[20:, 1]) - np.mean(end[:20, 1]))


@pytest.mark.long
@BOTH
def test_driven_filaments_cross_only_faster_than_the_limit(gradient, float64):
    for speed in (0.05, 0.095):
        assert driven_together(gradient, speed, float64) > 1
    assert driven_together(gradient, 0.2, float64) < 0


SIZE, STEPS = (32, 32), 80


@pytest.fixture
def forager(float64):
    """A function that makes a world with packets, its start and the shapes of a swimmer."""

    def make(layers=1, rate=None, diffusion=None):
        body = bodies.chain(12, 1.0)
        packets = fields.packets(SIZE, fields.Packets(6, 3.0, 0.5, 2))
        given = (x if x is None else array(x) for x in (diffusion, rate))
        energy = fields.Energy(array(packets), *given)
        form = world.Form(layers=layers)
        box, start = scenes.immersed(body, 0.1, float64, size=SIZE, form=form, energy=energy)
        wave = np.sin(np.arange(STEPS)[:, None] / 12 - np.arange(10)[None] / 3)
        return box, start, scenes.rest(body, 0.2 * wave, float64)

    return make


def totals(state, _):
    return state.positions, jnp.sum(state.energy), jnp.sum(state.collected)


def watched(box, start, rest):
    """The end, and positions, sums of the field and of what was collected after every step."""
    return jax.jit(world.rollout, static_argnums=3)(box, start, rest, totals)


def interpolated(plane, positions):
    """The plane at positions with Peskin's delta, written out over all cells."""
    weights = []
    for axis, side in enumerate(SIZE):
        away = np.arange(side)[None] - positions[:, axis, None]
        weights.append(weight(away - side * np.round(away / side)))
    return np.einsum("px,py,xy->p", *weights, plane)


def test_nodes_collect_the_sum_over_steps_of_a_constant_field(forager):
    box, start, rest = forager()
    end, (positions, left, _) = watched(box, start, rest)
    places = np.concatenate([start.positions[None], positions[:-1]])
    plane = np.asarray(start.energy)
    expected = sum(interpolated(plane, x) for x in places)
    assert np.asarray(end.collected).std() > 0.1
    np.testing.assert_allclose(end.collected, expected, rtol=1e-11)
    np.testing.assert_allclose(left, plane.sum(), rtol=1e-14)


@pytest.mark.long
@pytest.mark.parametrize(
    ("layers", "rate", "diffusion"), [(1, 0.1, None), (2, 1.0, None), (2, 0.3, 0.2)]
)
def test_collected_energy_is_removed_from_the_field(layers, rate, diffusion, forager):
    box, start, rest = forager(layers, rate, diffusion)
    end, (_, left, collected) = watched(box, start, rest)
    before = float(start.energy.sum())
    assert float(collected[-1]) > 0.02 * before
    np.testing.assert_allclose(np.asarray(left) + collected, before, rtol=1e-12)
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
    np.testing.assert_allclose(jax.jit(world.sense)(box, start), expected, rtol=1e-12)


def test_without_a_field_nothing_is_sensed_or_collected(float64):
    box, start = scenes.immersed(bodies.chain(12, 1.0), 0.1, float64, size=SIZE)
    np.testing.assert_array_equal(jax.jit(world.sense)(box, start), np.zeros(12))
    rest = jax.tree.map(lambda x: x[0], scenes.held(bodies.chain(12, 1.0), 1, float64))
    assert jax.jit(world.step)(box, start, rest)[0].collected is None
