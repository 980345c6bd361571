"""Kinematics of grown bodies: closed forms against least squares, edges and angles."""

import body_plans
import numpy as np
import pytest
from body_plans import CAPACITY

from microcosmos import bodies


@pytest.mark.parametrize("part", range(4))
def test_the_kinematics_are_those_of_least_squares(population, part):
    """Of bodies with rings, of several rings, of many limbs, and of any."""
    _, grown, bones, *_ = population
    rings = (grown.ring_first >= 0).sum(1)
    kinds = rings == 1, rings > 1, grown.degree.max(1) > 3, rings >= 0
    chosen = np.flatnonzero(kinds[part])[:15]
    assert len(chosen)
    for index in chosen:
        body, bone = (body_plans.member(one, index) for one in (grown, bones))
        layout = bodies.layout(body_plans.graph(body, bone))
        turned = bone.turned[bone.edge_present][:, bone.bends]
        np.testing.assert_allclose(turned, layout.turned, atol=1e-6)
        placed = bone.placed[body.present][:, bone.edge_present]
        np.testing.assert_allclose(placed, layout.placed, atol=1e-6)
        assert not bone.turned[~bone.edge_present].any()
        assert not bone.turned[:, ~bone.bends].any()
        assert not bone.placed[~body.present].any()
        assert not bone.placed[:, ~bone.edge_present].any()


def test_lengths_and_angles_are_those_of_the_positions(population):
    _, grown, bones, *_ = population
    index = np.arange(len(grown.present))[:, None]
    ends = grown.positions.astype(float)[index[:, None], bones.edges]
    v = ends[:, :, 1] - ends[:, :, 0]
    there, bends = bones.edge_present, bones.bends
    np.testing.assert_allclose(np.linalg.norm(v, axis=-1)[there], CAPACITY.spacing, atol=2e-5)
    angle = np.arctan2(v[..., 1], v[..., 0])
    assert np.abs(_wrapped(angle - bones.angle))[there].max() < 5e-5
    turn = angle[index, bones.joints[..., 1]] - angle[index, bones.joints[..., 0]]
    assert np.abs(_wrapped(turn - bones.rest_angle))[bends].max() < 1e-4


def test_joints_are_of_edges_that_share_a_node_and_have_their_far_node_as_driver(population):
    _, _, bones, *_ = population
    index = np.arange(len(bones.edge_present))[:, None]
    first, second = (bones.edges[index, bones.joints[..., end]] for end in (0, 1))
    shared = (first[..., :, None] == second[..., None, :]).any((-1, -2))
    assert shared[bones.bends].all()
    pairs = np.sort(bones.joints, -1) @ [CAPACITY.edges, 1]
    for mine, found in zip(bones.bends, pairs, strict=True):
        assert len(set(found[mine].tolist())) == mine.sum()


def _wrapped(angle):
    return angle - 2 * np.pi * np.round(angle / (2 * np.pi))
