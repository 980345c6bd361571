"""Actuators: bounded speed, lag and bend, in open and in closed loop."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments, genomes, search, spec, world
from microcosmos.build import build_layout, build_task
from microcosmos.device import array
from microcosmos.genomes import Actuators, Drive, actuators
from microcosmos.spec.evolution import UNLIMITED

STEPS = 300


@pytest.mark.parametrize("name", ["max_speed", "max_bend"])
def test_a_bound_is_above_0(name):
    layout = build_layout(bodies.chain(3, 1.0))
    with pytest.raises(ValueError, match=f"`{name}` must be above 0, or None"):
        Actuators(layout, **{name: 0.0})


@pytest.fixture
def scene(float64):
    """A world with a filament, its layout, and a drive that bends it `rate` rad a step."""
    body = bodies.chain(9, 1.0)
    place = spec.World(width=32, height=32)
    task = build_task(spec.Scene(world=place, body=spec.Chain(nodes=9)), float64)
    layout = build_layout(body, float64)

    def bending(rate, waves=0.0):
        time = np.arange(1, STEPS + 1)[:, None]
        turn = 0.3 * np.sin(rate / 0.3 * time - waves * np.arange(7)[None])
        start = np.sin(-waves * np.arange(7))[None] * 0.3
        rest = filaments.Rest(array(turn - start), array(np.ones((STEPS, 8))))
        return Drive(task.world, task.start, rest)

    return layout, bending


def carried_out(driven, limits):
    """Rest shapes and clock in open loop, from one program."""

    @jax.jit
    def bounded(rest):
        found = genomes.carried_out(replace(driven, inputs=rest), limits)
        return found.inputs, found.clock

    inputs, clock = bounded(driven.inputs)
    return replace(driven, inputs=inputs, clock=clock)


def fastest(rest, layout):
    """The greatest speed of a node."""
    return np.max(jax.jit(lambda rest: actuators.speeds(rest, layout, None))(rest))


def test_a_slow_gait_is_carried_out_as_commanded(scene):
    layout, bending = scene
    driven = bending(1e-3, waves=0.5)
    found = carried_out(driven, Actuators(layout, max_speed=0.1))
    np.testing.assert_allclose(found.inputs.angle, driven.inputs.angle, atol=1e-12)
    np.testing.assert_allclose(found.clock, np.arange(1, STEPS + 1), atol=1e-9)


def test_the_clock_of_a_fast_gait_slows_and_no_node_is_faster_than_the_bound(scene):
    layout, bending = scene
    driven = bending(0.05, waves=0.5)
    found = carried_out(driven, Actuators(layout, max_speed=0.02))
    # Shapes between two commands are bent linearly, which is exact to second order.
    assert 0.0195 < fastest(found.inputs, layout) < 0.0205
    assert fastest(driven.inputs, layout) > 0.1
    clock = np.asarray(found.clock)
    assert np.all(np.diff(clock) > 0)
    # The same shapes, later.
    at = np.searchsorted(clock, 20.0)
    expected = np.asarray(driven.inputs.angle)[19]
    assert at > 100
    np.testing.assert_allclose(np.asarray(found.inputs.angle)[at], expected, atol=0.03)


def test_a_lag_is_a_first_order_response(scene):
    layout, bending = scene
    driven = bending(0.0)
    rest = filaments.Rest(array(np.full((STEPS, 7), 0.2)), array(np.ones((STEPS, 8))))
    step = replace(driven, inputs=rest)
    found = carried_out(step, Actuators(layout, lag=9.0)).inputs.angle
    np.testing.assert_allclose(
        np.asarray(found)[:, 0], 0.2 * (1 - 0.9 ** np.arange(1, STEPS + 1)), rtol=1e-12
    )


def test_the_bend_of_the_whole_body_is_bounded(scene):
    layout, _ = scene
    angle = jnp.asarray(np.outer([0.1, 0.3, -0.6], np.ones(7)))
    rest = filaments.Rest(angle, jnp.ones((3, 8)))
    box = build_task(spec.Scene(body=spec.Chain(nodes=9))).world
    found = actuators.bounded(rest, Actuators(layout, max_bend=2.1), box)
    np.testing.assert_allclose(found.angle[:, 0], [0.1, 0.3, -0.3], rtol=1e-12)
    np.testing.assert_allclose(jnp.ptp(filaments.turns(found, layout), 1), [0.7, 2.1, 2.1])


@pytest.mark.parametrize("bounds", [{"lag": 5.0}, {"max_speed": 0.02}, {"max_bend": 1.0}])
def test_a_closed_loop_has_the_same_bounds(scene, bounds):
    layout, bending = scene
    driven, limits = bending(0.004, waves=0.5), Actuators(layout, **bounds)

    def control(box, state, index):
        return jax.tree.map(lambda x: x[index], driven.inputs)

    closed = Drive(
        driven.world, driven.start, (jnp.arange(STEPS),), lambda b, s, g: control(b, s, *g)
    )

    def rests_of(driven):
        one = genomes.carried_out(driven, limits)
        return world.rollout(
            one.world, one.start, one.inputs, lambda s, m: m.rest, one.control, one.remember
        )[1]

    rests = jax.jit(lambda: [rests_of(one) for one in (closed, driven)])()
    # It cuts corners that the open loop takes slowly.
    atol = 0.1 if "max_speed" in bounds else 1e-9
    np.testing.assert_allclose(rests[0].angle, rests[1].angle, atol=atol)
    if "max_speed" in bounds:
        assert fastest(rests[0], layout) < 0.0205


def test_they_can_be_differentiated(scene, require_slope):
    layout, bending = scene
    driven, limits = bending(0.02, waves=0.5), Actuators(layout, 0.05, 5.0, 4.0)

    def value(rest):
        found = genomes.carried_out(replace(driven, inputs=rest), limits).inputs
        return jnp.sum(found.angle[::7] * found.angle[3::7][: len(found.angle[::7])])

    require_slope(value, driven.inputs, rtol=1e-5)


def test_bounded_actuators_keep_random_controllers_from_the_limits():
    """Median share of node steps at a limit over random networks, with and without bounds."""
    shares = {}
    for name, bounds in {"bounded": {}, "unbounded": UNLIMITED}.items():
        control = spec.Control(period=60, angle_scale=0.4, **bounds)
        place, body = spec.World(width=32, height=32), spec.Chain(nodes=16)
        chosen = spec.Scene(world=place, body=body, control=control, task=spec.Task(steps=240))
        task = build_task(chosen)
        block = search.block_program(
            lambda genotype, task=task: search.evaluate(task, genotype)
        )
        keys = jax.random.split(jax.random.key(3), 24)
        newcomers = jax.jit(jax.vmap(lambda key, task=task: task.encoding.newcomer(key=key)))(
            keys
        )
        found = block(newcomers).measures[:, search.MEASURES.index("limited")]
        shares[name] = np.asarray(found)
    assert np.mean(shares["bounded"] > 1e-3) < 0.1
    assert np.mean(shares["unbounded"] > 1e-3) > 0.5
