"""Bodies that grow from plans: drawings, estimates and the graph of a creature."""

import re
from io import BytesIO

import h5py
import numpy as np
import pytest
from grown_bodies import grown_file, grown_scene
from pydantic import ValidationError

from microcosmos.archive import creature_h5
from microcosmos.spec import drawing, parse

ZOO = {
    "experiment": "quality-diversity",
    "body": {"builder": "grown"},
    "control": {"encoding": "body-graph"},
    "genome": {"max_nodes": 32, "max_connections": 96},
}


def test_a_search_for_bodies_is_drawn_by_random_plans_of_its_seed():
    found, again, other = (drawing(parse({**ZOO, "seed": seed})) for seed in (1, 1, 2))
    assert [body.name for body in found.bodies] == [f"random plan {n}" for n in range(1, 13)]
    for body, same in zip(found.bodies, again.bodies, strict=True):
        np.testing.assert_array_equal(body.positions, same.positions)
        np.testing.assert_allclose(body.positions.mean(0), [24, 24])
        a, b = body.positions[body.edges].swapaxes(0, 1)
        np.testing.assert_allclose(np.hypot(*(b - a).T), 1, rtol=1e-5)
    assert [body.nodes for body in found.bodies] != [body.nodes for body in other.bodies]


def test_a_refined_creature_is_drawn_as_it_has_grown():
    file = grown_file(grown_scene())
    (body,) = drawing(parse({"experiment": "refinement", "creature": file})).bodies
    assert (body.nodes, len(body.edges)) == (26, 26)


def test_an_hdf5_file_holds_the_grown_body_and_its_plan():
    file = grown_file(grown_scene())
    data = creature_h5.dump(file)
    assert creature_h5.load(data) == creature_h5.parse(file)
    with h5py.File(BytesIO(data), "r") as tree:
        plan = tree["genome/plan"]
        assert tree["body/positions"].shape == (26, 2)
        np.testing.assert_array_equal(plan["nodes"], [8, 4, 9])
        np.testing.assert_allclose(plan["angle"], [0, 1.1, -0.6], rtol=1e-6)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"coupling": {"nu_c": 1.0}}, "`coupling.nu_c` must be empty where `body.builder`"),
        (
            {"coupling": {"projection": "force", "theta_feedback": 0}},
            "`coupling.theta_feedback` must be 1 where `body.builder` is 'grown'",
        ),
        (
            {"experiment": "folding", "control": {}, "genome": None},
            "`body` must have a fixed graph to be folded",
        ),
    ],
    ids=["nu_c", "theta_feedback", "folding"],
)
def test_what_a_grown_body_cannot_have_is_refused(changes, reason):
    given = {name: value for name, value in (ZOO | changes).items() if value is not None}
    with pytest.raises(ValidationError, match=re.escape(reason)):
        parse(given)
