"""Bodies far from the origin: positions within a box plus whole boxes lose no motion.

A float32 near 10⁵ holds steps of 0.008, more than a swimmer moves in a step.
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kernel_scenes import SCENES, moved

from microcosmos import bodies, filaments, groups, search, world
from microcosmos.build import build_rods
from microcosmos.build.scene import build_layout
from microcosmos.fluid import lattice
from microcosmos.genomes import Drive
from microcosmos.search.evaluation import poses_of
from validation.paths import paths, roll

SIDES = (64, 48)
STEPS, PERIOD = 300, 60
BODY = bodies.chain(16, 1.0, stretch=1.0, shear=1.0, bend=1.0)


@pytest.fixture(params=paths(), ids=lambda path: path.name)
def path(request):
    return request.param


def swimmer(place=(32.0, 24.0)):
    """A chain that a travelling wave drives along −x, from a place of its middle."""
    box = world.World(
        viscosity=jnp.asarray(0.05, jnp.float32),
        rods=build_rods(BODY),
        groups=groups.single(16),
        size=SIDES,
        layout=build_layout(BODY),
    )
    # Whole 64ths, which a float holds near 145,952 too.
    positions = BODY.positions - BODY.positions.mean(0) + np.array(place)
    time = np.arange(STEPS)[:, None] / PERIOD
    joint = np.arange(14)[None] / 14
    angle = 0.4 * np.minimum(1, time) * np.sin(2 * np.pi * (joint - time))
    rest = filaments.Rest(jnp.asarray(angle, jnp.float32), jnp.ones((STEPS, 15), jnp.float32))
    return box, world.at_rest(box, jnp.asarray(positions, jnp.float32)), rest


def everything(seen):
    return seen


def shown(box, start, rest, end, observed):
    """The measures and the recorded poses of a motion, as an evaluation has them."""

    def all_of(start, end, observed):
        task = search.Task(box, start, length=16.0, period=float(PERIOD))
        driven = Drive(box, start, rest)
        return search.motion_of(task, driven, end, observed), poses_of(task, driven, observed)

    return jax.jit(all_of)(start, end, observed)


def swum(path, box, start, rest):
    """The way that the middle of the body takes in each step, in float64."""
    _, seen = roll(path, box, start, rest, everything)
    boxes = np.concatenate([start.boxes[:1], seen.boxes[:, 0]]).astype(float)
    centres = np.concatenate([[np.mean(start.positions, 0)], seen.centre]).astype(float)
    return np.diff(centres + boxes * SIDES, axis=0)


@pytest.mark.parametrize("boxes", [1e6, -1e6])
def test_the_motion_in_the_millionth_box_is_that_in_the_first(path, boxes):
    box, start, rest = swimmer((1.5, 24.0))  # It leaves its box, and swims on in the next.
    end, seen = roll(path, box, start, rest, everything)
    far = replace(start, boxes=start.boxes + boxes)
    away, observed = roll(path, box, far, rest, everything)
    assert float(end.boxes[0, 0]) < 0
    np.testing.assert_array_equal(away.boxes - end.boxes, boxes)
    np.testing.assert_array_equal(observed.boxes - boxes, seen.boxes)
    for one, other in ((observed, seen), (away, end)):
        one, other = ({**vars(each), "boxes": None} for each in (one, other))
        jax.tree.map(np.testing.assert_array_equal, one, other)


@pytest.mark.parametrize("far", [16_640, 145_920])
def test_a_body_that_is_placed_far_away_swims_as_near_the_origin(path, far):
    here = swum(path, *swimmer()).sum(0)
    assert here[0] < -1
    there = swum(path, *swimmer((32.0 + far, 24.0))).sum(0)
    np.testing.assert_allclose(there, here, atol=1e-4)


@pytest.mark.parametrize("place", [(2.0, 24.0), (8.0, 0.0), (63.0, 47.0)])
def test_measures_and_poses_do_not_notice_that_a_body_leaves_its_box(path, place):
    middle, leaving = swimmer(), swimmer(place)
    found, poses = shown(*leaving, *roll(path, *leaving, everything))
    expected, others = shown(*middle, *roll(path, *middle, everything))
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], value, 1e-3, 1e-5, err_msg=name)
    # A recorded level is 6e-4 cells here.
    np.testing.assert_allclose(poses.positions, others.positions, atol=2)
    shift = np.array(place) - (32.0, 24.0)
    np.testing.assert_allclose(
        poses.middles - others.middles, shift[None] + 0 * others.middles, atol=1e-3
    )
    np.testing.assert_allclose(
        poses.path - others.path, shift[None] + 0 * others.path, atol=1e-3
    )


def stream(velocity):
    """Populations of a fluid that flows evenly, to second order in the velocity."""
    found = []
    for weight, direction in zip(lattice.WEIGHTS, lattice.DIRECTIONS, strict=True):
        along = np.dot(direction, velocity)
        value = weight * (3 * along + 4.5 * along**2 - 1.5 * np.dot(velocity, velocity))
        found.append(jnp.full(SIDES, value, jnp.float32))
    return tuple(found)


def test_a_flow_carries_a_body_through_many_boxes(path):
    """A passive body goes as far as the fluid, and its path is as long as that."""
    velocity, (box, start, _) = np.array([0.1, -0.06]), swimmer()
    steps = 4000
    still = filaments.Rest(jnp.zeros((steps, 14)), jnp.ones((steps, 15)))
    start = replace(start, populations=stream(velocity))
    end, seen = roll(path, box, start, still, everything)
    values, poses = shown(box, start, still, end, seen)
    assert np.asarray(seen.boxes[-1, 0]).tolist() == [6.0, -5.0]
    first = np.asarray(seen.positions)[:, 0]
    assert (first >= 0).all()
    assert (first <= SIDES).all()
    way = np.hypot(*velocity) * steps
    for name in ("displacement", "path_length"):
        assert float(values[name]) == pytest.approx(way, rel=1e-4)
    assert float(values["straightness"]) == pytest.approx(1, abs=1e-5)
    whole = np.asarray(poses.path)[-1] - np.asarray(poses.path)[0]
    np.testing.assert_allclose(whole, velocity * steps, rtol=1e-4)
    ahead = seen.centre[-1] + seen.boxes[-1, 0] * np.float32(SIDES)
    np.testing.assert_allclose(poses.path[-1], ahead, atol=1e-3)


def test_several_bodies_keep_their_distance_whatever_boxes_they_are_in(path):
    """The centre and the poses of a shoal, some of which leave the box, are those of all."""
    middle = SCENES["three bodies"]()
    shift = np.array([37.0, -14.0])  # The first and the last body stand beyond the edges.
    leaving = moved(middle, shift)
    end, seen = roll(path, *leaving, everything)
    assert len(np.unique(end.boxes, axis=0)) == 3
    found, poses = shown(*leaving, end, seen)
    expected, others = shown(*middle, *roll(path, *middle, everything))
    for name, value in expected.items():
        # The direction of a shoal that hardly moves depends on rounding.
        off = 1e-3 if name == "heading_angle" else 1e-5
        np.testing.assert_allclose(found[name], value, 1e-3, off, err_msg=name)
    np.testing.assert_allclose(poses.positions, others.positions, atol=2)
    np.testing.assert_allclose(
        poses.path - others.path, shift[None] + 0 * others.path, atol=1e-3
    )
