"""The gaits of the known swimmers do what their descriptions promise."""

import numpy as np
import pytest

from microcosmos.bodies import swimmers

pytestmark = pytest.mark.fast

TIMES = np.arange(240) / 240


def ends(body, joints):
    """The two nodes of each joint that are not shared, and the shared one."""
    first, second = body.edges[body.joints[joints, 0]], body.edges[body.joints[joints, 1]]
    node = body.joint_nodes[joints]
    return first.sum(1) - node, node, second.sum(1) - node


@pytest.mark.parametrize("name", swimmers.SWIMMERS)
def test_a_gait_repeats_every_period_without_jumps(name):
    swimmer = swimmers.SWIMMERS[name]()
    body, gait = swimmer.body, swimmer.gait
    assert swimmer.name == name
    for now, later in zip(gait(TIMES), gait(TIMES + 3), strict=True):
        np.testing.assert_allclose(now, later, atol=1e-9)
    angle, length = gait(np.linspace(0, 1, 6001))
    assert angle.shape == (6001, len(body.joints))
    assert length.shape == (6001, len(body.edges))
    assert 0 < np.abs(np.diff(angle, axis=0)).max() <= 0.01
    assert np.abs(np.diff(length, axis=0)).max() <= 0.01


@pytest.mark.parametrize("name", swimmers.SWIMMERS)
def test_a_swimmer_has_the_given_stiffness(name):
    stiffness = {"stretch": 0.9, "shear": 0.8, "bend": 0.7}
    body = swimmers.SWIMMERS[name](**stiffness).body
    for field, value in stiffness.items():
        np.testing.assert_array_equal(getattr(body, field), value)


@pytest.mark.parametrize(("waves", "shift"), [(1.0, 0.25), (2.0, 0.125)])
def test_a_wave_runs_along_the_worm_from_its_first_joint(waves, shift):
    angle, length = swimmers.worm(nodes=43, amplitude=0.2, waves=waves).gait(TIMES)
    later, _ = swimmers.worm(nodes=43, amplitude=0.2, waves=waves).gait(TIMES + shift * waves)
    moved = round(shift * 40)
    np.testing.assert_allclose(later[:, moved:], angle[:, : 41 - moved], atol=1e-12)
    np.testing.assert_allclose(np.abs(angle).max(), 0.2, rtol=1e-3)
    assert not length.any()


def test_the_tadpole_is_a_worm_with_a_rigid_head():
    swimmer = swimmers.tadpole(head_nodes=14, tail_nodes=24)
    angle, length = swimmer.gait(TIMES)
    assert not length.any()
    in_tail = np.all(swimmer.body.joints >= 14, 1)
    assert not angle[:, ~in_tail].any()
    before, node, after = ends(swimmer.body, in_tail)
    np.testing.assert_array_equal(np.diff(node), 1)
    assert np.all(before[1:] == node[:-1])
    assert np.all(after == node + 1)
    wave, _ = swimmers.worm(nodes=25, amplitude=0.18).gait(TIMES)
    np.testing.assert_allclose(angle[:, in_tail], wave, atol=1e-12)
    # Head and tail are one: a closed ring of 14, and 24 more nodes from one of its nodes.
    degree = np.bincount(swimmer.body.edges.reshape(-1))
    assert sorted(degree) == [1, *[2] * 36, 3]


def test_the_ray_beats_at_one_joint_and_comes_back_the_way_it_went():
    angle, length = swimmers.ray().gait(TIMES)
    assert not length.any()
    beating = np.flatnonzero(np.any(angle, 0))
    np.testing.assert_array_equal(beating, [14])
    beat = angle[:, 14]
    np.testing.assert_allclose((beat.min(), beat.max()), (-0.3, 1.3), atol=1e-12)
    there, back = swimmers.ray().gait(0.25 + TIMES), swimmers.ray().gait(0.25 - TIMES)
    np.testing.assert_allclose(there[0], back[0], atol=1e-12)


@pytest.mark.parametrize("name", ["worm", "tadpole", "cilia", "jellyfish"])
def test_no_other_swimmer_comes_back_the_way_it_went(name):
    gait = swimmers.SWIMMERS[name]().gait
    shapes = [np.concatenate(gait(t), 1) for t in (TIMES, -TIMES)]
    size = np.abs(shapes[0]).max()
    nearest = min(np.abs(np.roll(shapes[1], k, 0) - shapes[0]).max() for k in range(len(TIMES)))
    assert nearest > 0.2 * size


def test_the_jellyfish_bends_and_stretches_alike_everywhere():
    swimmer = swimmers.jellyfish(bending=0.25, stretching=0.08)
    angle, length = swimmer.gait(TIMES)
    share = angle / swimmer.body.rest_angle[None]
    np.testing.assert_allclose(np.ptp(share, axis=1), 0, atol=1e-12)
    np.testing.assert_allclose(np.ptp(length, axis=1), 0, atol=1e-12)
    np.testing.assert_allclose((share.min(), share.max()), (-0.25, 0.25), rtol=1e-10)
    np.testing.assert_allclose((length.min(), length.max()), (-0.08, 0.08), rtol=1e-10)
    # A quarter of a period apart, so that lengths and angles go round a circle.
    circle = (share[:, 0] / 0.25) ** 2 + (length[:, 0] / 0.08) ** 2
    np.testing.assert_allclose(circle, 1, rtol=1e-10)


@pytest.mark.parametrize("count", [0, 1, 5])
def test_cilia_need_as_many_hairs_on_both_flanks(count):
    with pytest.raises(ValueError, match="`hairs` must be an even number"):
        swimmers.cilia(hairs=count)
