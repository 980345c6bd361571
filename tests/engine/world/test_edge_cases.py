"""Bodies of which nothing has grown, bodies in one place, and joints around a branch."""

from dataclasses import replace

import jax
import numpy as np
import pytest
from kernel_scenes import at_rest, chain, grown_alone, repelling, scene, shoal, single

from microcosmos import bodies, fields, filaments, world
from validation.paths import paths, roll


@pytest.fixture(params=paths(), ids=lambda path: path.name)
def path(request):
    return request.param


def everything(seen):
    return seen


NUMBERS = ("centre", "node_speed", "held", "heading", "power", "speed")


@pytest.mark.parametrize("repelled", [False, True], ids=["free", "repelled"])
@pytest.mark.parametrize("matched", [True, False], ids=["matched", "swept"])
def test_a_body_of_which_nothing_has_grown_changes_nothing(path, matched, repelled):
    make = repelling if repelled else scene
    box, start, rest = make(shoal(), matched=matched)
    empty = grown_alone(box, np.arange(33) // 11 != 1)
    end, seen = roll(path, empty, start, rest, everything)
    places = (((12.3, 14.2), 0.3), ((24.0, 34.4), 4.0))
    two = bodies.combined([bodies.placed(chain(11), *place) for place in places])
    other, _, _ = make(two, matched=matched)
    kept = np.r_[:11, 22:33]
    begun = at_rest(other, np.asarray(start.positions)[kept])
    joints, edges = np.r_[:9, 18:27], np.r_[:10, 20:30]
    rest = filaments.Rest(rest.angle[:, joints], rest.length[:, edges])
    alone, expected = roll(path, other, begun, rest, everything)
    exact = path.name == "kernel"
    for found, wanted in (
        (np.asarray(end.positions)[kept], alone.positions),
        (end.populations, alone.populations),
        (np.asarray(seen.curvature)[:, joints], expected.curvature),
        (np.asarray(seen.force)[:, [0, 2]], expected.force),
    ):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=0 if exact else 2e-5)
    np.testing.assert_array_equal(np.asarray(end.positions)[11:22], start.positions[11:22])
    np.testing.assert_array_equal(np.asarray(seen.force)[:, 1], 0)
    for name in NUMBERS:  # Sums over all bodies, in another order.
        found, wanted = (np.asarray(getattr(one, name)) for one in (seen, expected))
        np.testing.assert_allclose(found, wanted, rtol=1e-4, atol=1e-5, err_msg=name)


@pytest.mark.parametrize("gradient", [fields.binomial, fields.gaussian])
@pytest.mark.parametrize("count", [2, 3])
def test_bodies_in_exactly_one_place_part(path, count, gradient):
    """They move apart as far as contact reaches, and together stay where they were."""
    steps, places = 300, [((8.0, 12.0 * number), 0.4) for number in range(count)]
    body = bodies.combined([bodies.placed(chain(11), *place) for place in places])
    box, start, _ = repelling(body, matched=True, gradient=gradient)
    one = np.asarray(start.positions)[:11]
    start = at_rest(box, np.tile(one - one.mean(0) + 24, (count, 1)).astype(np.float32))
    shape = (np.tile(each[None], (steps, 1)) for each in (body.rest_angle, body.rest_length))
    rest = filaments.Rest(*(single(each) for each in shape))
    _, seen = roll(path, box, start, rest, everything)
    nodes = np.asarray(jax.jit(world.unwrapped)(box, seen)).reshape(steps, count, 11, 2)
    centres = nodes.mean(2)
    np.testing.assert_allclose(centres[0].mean(0), 24, atol=2e-5)
    ways = centres[-1][:, None] - centres[-1][None]
    assert np.linalg.norm(ways, axis=2)[~np.eye(count, dtype=bool)].min() > 1
    if count == 2:  # Three may cross.
        gaps = np.linalg.norm(nodes[-1, 0][:, None] - nodes[-1, 1][None], axis=2)
        assert gaps.min() > 2
    # Limits shorten the displacement of each body on its own.
    np.testing.assert_allclose(centres[-1].mean(0), 24, atol=0.05 if count == 2 else 1)


TURNS = {"stiff": 1.0, "soft": 0.3}


@pytest.mark.parametrize(("arms", "turn"), [(3, 0.3), (4, -0.3), (7, 0.5), (3, 1.2)])
@pytest.mark.parametrize("bend", TURNS.values(), ids=TURNS)
def test_equal_joints_at_a_branch_share_what_they_cannot_meet(path, bend, arms, turn):
    """All joints of a branch are asked to open; the angles around it have one sum."""
    star = bodies.star(arms, 4, 1.0)
    branch = np.isclose(np.abs(star.rest_angle), 2 * np.pi / arms)
    assert branch.sum() == arms
    star = replace(star, bend=np.full(len(star.joints), bend))
    box, start, _ = scene(star, fluid=False)
    wanted = np.tile(star.rest_angle + turn * branch, (200, 1))
    rest = filaments.Rest(single(wanted), single(np.tile(star.rest_length, (200, 1))))
    end, _ = roll(path, box, start, rest, everything)
    first, second = star.joints[branch].T
    angles = np.asarray(end.angles)
    left = angles[second] - angles[first] - star.rest_angle[branch]
    np.testing.assert_allclose(np.sin(left), 0, atol=2e-5)
    assert (np.cos(left) > 0).all()


def test_a_joint_without_stiffness_takes_up_the_misfit(path):
    star = bodies.star(3, 4, 1.0)
    branch = np.flatnonzero(np.isclose(np.abs(star.rest_angle), 2 * np.pi / 3))
    stiffness = np.ones(len(star.joints))
    stiffness[branch[1]] = 0
    star = replace(star, bend=stiffness)
    box, start, _ = scene(star, fluid=False)
    wanted = star.rest_angle.copy()
    wanted[branch] += 0.2
    rest = [single(np.tile(each, (200, 1))) for each in (wanted, star.rest_length)]
    end, _ = roll(path, box, start, filaments.Rest(*rest), everything)
    first, second = star.joints[branch].T
    angles = np.asarray(end.angles)
    turn = angles[second] - angles[first] - star.rest_angle[branch]
    np.testing.assert_allclose(np.sin(turn), np.sin([0.2, -0.4, 0.2]), atol=1e-3)
