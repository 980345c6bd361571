"""Bodies without a fluid: constraints alone move them."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments, spec, world
from microcosmos.build import build_world

FORM = {"projection": "force", "theta_feedback": 0, "limits": False}


def alone(body, dtype, **form):
    place = spec.World(width=48, height=48, fluid=False)
    box = build_world(place, spec.Coupling(**FORM | form), body, dtype)
    positions = body.positions - body.positions.mean(0) + 24
    return box, world.at_rest(box, jnp.asarray(positions, dtype))


def bent(body, angle, steps, dtype):
    return filaments.Rest(
        jnp.full((steps, len(body.joints)), angle, dtype),
        jnp.tile(jnp.asarray(body.rest_length, dtype), (steps, 1)),
    )


@pytest.mark.parametrize("layers", [1, 2])
def test_a_filament_takes_its_rest_shape_and_its_middle_stays(float64, layers):
    body = bodies.chain(9, 1.0)
    box, start = alone(body, float64, layers=layers)
    end, seen = jax.jit(lambda: world.rollout(box, start, bent(body, 0.3, 300, float64),
                                              lambda s, m: m.force))()  # fmt: skip
    np.testing.assert_allclose(np.diff(end.angles), 0.3, atol=1e-6)
    steps = np.diff(end.positions, axis=0)
    np.testing.assert_allclose(np.hypot(*steps.T), 1.0, atol=1e-6)
    np.testing.assert_allclose(np.mean(end.positions, 0), np.mean(start.positions, 0))
    assert not np.any(seen)


def test_there_is_no_flow(float64):
    body = bodies.chain(9, 1.0)
    box, start = alone(body, float64)
    end, _ = jax.jit(lambda: world.rollout(box, start, bent(body, 0.3, 20, float64)))()
    assert not np.any(world.flow(box, end))


def test_limits_hold_without_a_fluid_too(float64):
    body = bodies.chain(9, 1.0)
    box, start = alone(body, float64, limits=True, max_displacement=0.01)
    end, _ = world.step(box, start, filaments.Rest(*(x[0] for x in (
        jnp.full((1, 7), 1.0), jnp.full((1, 8), 1.0)))))  # fmt: skip
    way = np.hypot(*(np.asarray(end.positions) - np.asarray(start.positions)).T)
    assert 0.0099 < way.max() <= 0.01 + 1e-12
