"""Obstacles keep bodies out, and bodies still do not push themselves."""

from dataclasses import replace

import jax
import numpy as np
import pytest

from microcosmos import bodies, fields, filaments, fluid, spec, world
from microcosmos.build import build_world
from microcosmos.device import array

SIZE = 48
POSTS = (spec.Post(x=30, y=20, radius=4), spec.Post(x=30, y=32, radius=3))


def among(obstacles, body, dtype, place, push=0.0, **options):
    """A body at a place, in a fluid driven along x past obstacles."""
    box = spec.World(width=SIZE, height=SIZE, obstacles=obstacles, **options)
    found = build_world(box, spec.Coupling(), body, dtype)
    force = array([push, 0.0], dtype)
    found = replace(found, surroundings=fluid.Surroundings(force, found.surroundings.solid))
    arms = body.positions - body.positions.mean(0)
    return found, jax.jit(world.at_rest)(found, array(arms + np.array(place), dtype))


def held(body, steps, dtype):
    """The rest shape of a body that does not move."""
    shapes = (np.tile(one, (steps, 1)) for one in (body.rest_angle, body.rest_length))
    return filaments.Rest(*(array(one, dtype) for one in shapes))


def depth(positions, obstacles):
    """Return how deep nodes are in posts, in cells; negative outside."""
    centres = np.array([(one.x, one.y) for one in obstacles])
    radii = np.array([one.radius for one in obstacles])
    away = np.asarray(positions)[:, :, None] - centres
    away -= SIZE * np.round(away / SIZE)
    return float(np.max(radii - np.hypot(*np.moveaxis(away, -1, 0))))


@pytest.mark.long
@pytest.mark.parametrize("body", [bodies.chain(16, 1.0), bodies.ring(20, 1.0)])
def test_a_flow_does_not_carry_a_body_into_posts(body, dtype):
    box, start = among(POSTS, body, dtype, (14.0, 22.0), push=3e-5)
    rest = held(body, 3000, dtype)
    _, seen = world.rollout(box, start, rest, lambda state, measures: measures)
    moved = float(world.route(box, start, seen).way(0, -1)[0])
    assert moved > 5
    assert depth(seen.positions, POSTS) < 0.5
    assert np.abs(np.cumsum(seen.force, 0)).max() < 1e-4


def test_without_contact_a_body_does_not_move(dtype):
    body = bodies.chain(16, 1.0)
    box, start = among(POSTS, body, dtype, (14.0, 22.0))
    end, _ = world.rollout(box, start, held(body, 20, dtype))
    np.testing.assert_allclose(end.positions, start.positions, atol=1e-5)


def test_displacements_point_out_of_a_straight_wall_and_vanish_beyond_their_reach():
    solid = np.zeros((16, 24), bool)
    solid[:, :5] = True
    away = fields.away(solid)
    np.testing.assert_allclose(away[0], 0)
    np.testing.assert_allclose(away[1, 3, 5:9], [1, 0.25, 0, 0])
    np.testing.assert_allclose(away[1, 3, 3:5], [3, 2])
    np.testing.assert_allclose(away[1, 3, 21:], [0, -0.25, -1])
