"""Measures of the form of bodies at rest, by closed forms."""

import body_plans
import numpy as np
import pytest
from body_plans import in_numpy, plan_of

from microcosmos import bodies
from microcosmos.bodies import growth, swimmers
from microcosmos.measures import FORMS

CORNERS = [[0, 0], [4, 0], [4, 4], [0, 4]]


def form_of(body, turn=0.0, pieces=1):
    every = np.ones(len(body.positions), bool), np.ones(len(body.edges), bool)
    c, s = np.cos(turn), np.sin(turn)
    turned = body.positions @ np.array([[c, s], [-s, c]])
    return growth.form(turned, body.edges, *every, pieces=pieces)


COUNTS = {
    "chain": (bodies.chain(9, 1.5), 1, 2, 0),
    "arc": (bodies.arc(12, 1.0, 0.4), 1, 2, 0),
    "ring": (bodies.ring(12, 1.0), 1, 0, 1),
    "star": (bodies.star(5, 4, 1.0), 5, 5, 0),
    "tree": (bodies.tree(3, 2, 4, 1.0, 1.2), 7, 5, 0),
    "tadpole": (swimmers.tadpole(10, 8).body, None, 1, 1),
}


@pytest.mark.parametrize("name", COUNTS)
def test_segments_limbs_and_rings_are_counted(name):
    body, segments, limbs, rings = COUNTS[name]
    found = form_of(body)
    if segments is not None:
        assert found["segments"] == segments
    assert (found["free_ends"], found["rings"]) == (limbs, rings)
    np.testing.assert_allclose(found["total_length"], body.rest_length.sum(), rtol=1e-6)
    assert found["ungrown"] == 0


def test_independent_loops_are_rings_also_in_several_bodies():
    ring = bodies.ring(12, 1.0)
    pair = bodies.combined([bodies.placed(ring, (0, 0)), bodies.placed(ring, (9, 0))])
    assert form_of(pair, pieces=2)["rings"] == 2
    spectacles = plan_of(
        {"nodes": 9},
        {"nodes": 11, "closed": True, "angle": np.pi},
        {"nodes": 11, "closed": True, "place": 1.0},
    )
    grown, bones = in_numpy(spectacles)
    given = grown.positions, bones.edges, grown.present, bones.edge_present
    found = growth.form(*given)
    assert (found["segments"], found["free_ends"], found["rings"]) == (3, 0, 2)
    np.testing.assert_allclose(found["form_symmetry"], 1, atol=1e-4)


SYMMETRIC = {
    **{name: COUNTS[name][0] for name in ("chain", "arc", "ring", "tree")},
    **{f"star of {arms}": bodies.star(arms, 4, 1.0) for arms in (3, 4, 5, 6)},
    "square": bodies.graph(np.array(CORNERS), [(0, 1), (1, 2), (2, 3), (3, 0)]),
}


@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("name", SYMMETRIC)
def test_symmetric_bodies_are_symmetric_however_they_lie(name, turn):
    np.testing.assert_allclose(form_of(SYMMETRIC[name], turn)["form_symmetry"], 1, atol=1e-4)


MIRRORED = {"nodes": 5, "place": 0.4, "angle": 0.9, "curl": 1.0, "mirrored": True}


def test_a_mirrored_plan_is_symmetric_and_one_without_images_is_not():
    found = [_form(plan_of({"nodes": 9}, MIRRORED | {"mirrored": x})) for x in (True, False)]
    np.testing.assert_allclose(found[0]["form_symmetry"], 1, atol=1e-4)
    assert found[1]["form_symmetry"] < 0.8


def test_the_aspect_is_that_of_the_second_moments():
    np.testing.assert_allclose(form_of(COUNTS["chain"][0])["form_aspect"], 0, atol=1e-4)
    np.testing.assert_allclose(form_of(COUNTS["ring"][0])["form_aspect"], 1, rtol=1e-5)
    cross = bodies.graph(
        np.array([[0, 0], [3, 0], [-3, 0], [0, 1], [0, -1]]), [(0, n) for n in range(1, 5)]
    )
    for turn in (0.0, 0.8):
        np.testing.assert_allclose(form_of(cross, turn)["form_aspect"], 1 / 3, rtol=1e-6)


def test_measures_stay_in_their_ranges(population):
    plans, grown, *_, forms = population
    assert set(forms) == set(FORMS)
    for name in ("form_symmetry", "form_aspect"):
        assert forms[name].min() >= 0
        assert forms[name].max() <= 1 + 1e-6
    rings = (grown.ring_first >= 0).sum(1)
    assert np.array_equal(forms["rings"], rings)
    edges = grown.present.sum(1) - 1 + rings
    spacing = body_plans.CAPACITY.spacing
    np.testing.assert_allclose(forms["total_length"], edges * spacing, rtol=1e-5)
    assert (grown.ungrown < plans.used.sum(1)).all()


def _form(plan):
    grown, bones = in_numpy(plan)
    assert grown.ungrown == 0
    return growth.form(grown.positions, bones.edges, grown.present, bones.edge_present)
