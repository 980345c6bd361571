"""The body plan, the stroke and the units of a creature, for its page."""

import numpy as np
import pytest
from answers import detail
from plans import FINS, ROOT, plan_identity


def test_a_plan_has_nodes_edges_and_segments(api, upload):
    sha = upload(plan_identity(ROOT, FINS))
    answer = api.get(f"creatures/{sha}/plan.json")
    kept = {"If-None-Match": answer.headers["etag"]}
    assert api.get(f"creatures/{sha}/plan.json", headers=kept).status_code == 304
    drawn = answer.json()
    assert [segment["grown"] for segment in drawn["segments"]] == [1, 2]
    assert len(drawn["edges"]) == len(drawn["nodes"]) - 1 == 16
    assert drawn["nodes"][0].keys() == {"x", "y", "segment", "copy", "hand", "side"}


def test_a_creature_without_plan_says_so(api, known):
    assert "'cppn'" in detail(api.get(f"creatures/{known}/plan.json"), 404)


def sperm(steps, period):
    return (2 * np.pi * steps / period) ** 0.25


def test_a_grown_body_follows_its_actuators(api, upload):
    identity = plan_identity(ROOT, FINS)
    control = identity["genome"]["control"]
    answer = api.get(f"creatures/{upload(identity)}/stroke.json")
    found = answer.json()
    # A step leaves the share lag / (1 + lag) of what actuators lack; stiff joints lack nothing.
    slowest = 1 / np.log(1 + 1 / control["lag"])
    assert found["period"] == control["period"]
    assert found["sperm"] == pytest.approx(sperm(slowest, control["period"]), rel=1e-9)
    # The root has 8 edges; a fin of 4 at its middle gets no farther than its ends.
    assert found["length"] == pytest.approx(8 * identity["body"]["spacing"])


def test_a_measured_creature_has_the_steps_of_its_own_stroke(api, upload, identity):
    """Its clock was slowed: its strokes took a quarter longer."""
    soft = identity(3)
    period = soft["genome"]["control"]["period"]
    measures = {"displacement": 3.0, "stride": 0.2, "speed": 200 / (1.25 * period)}
    measured = {"fitness": 3.0, "descriptors": {"stride": 0.2}, "measures": measures}
    measured |= {"block": 16, "room": [24, 64], "device": "elsewhere"}
    found = api.get(f"creatures/{upload(soft, measured, None)}/stroke.json").json()
    alone = api.get(f"creatures/{upload(identity(4))}/stroke.json").json()
    assert (found["period"], alone["period"]) == (pytest.approx(1.25 * period), period)
    assert found["sperm"] == pytest.approx(alone["sperm"] / 1.25**0.25, rel=1e-6)


@pytest.mark.parametrize("nodes", [24, 300])
def test_a_swept_chain_relaxes_by_diffusion_of_its_errors(api, upload, identity, nodes):
    soft = identity(2)
    soft["genome"]["control"] |= {"lag": 0, "max_speed": None, "max_bend": None}
    soft["body"] = soft["body"] | {"nodes": nodes, "bend": 0.01}
    soft["world"] = soft["world"] | {"width": 400, "height": 400}
    found = api.get(f"creatures/{upload(soft)}/stroke.json").json()
    # A sweep of soft joints is a step of C' = k/2 C''; there are ten a step.
    slowest = 2 / (0.01 * (np.pi / (nodes - 1)) ** 2) / 10
    assert found["sperm"] == pytest.approx(sperm(slowest, found["period"]), rel=2e-3)
    assert found["length"] == pytest.approx(nodes - 1)


def test_a_creature_without_a_stroke_has_none(api, upload, identity):
    linear = identity(2)
    linear["genome"]["control"]["timer"] = "linear"
    linear["genome"]["inputs"] = ["position", "time"]
    linear["task"]["fitness"] = "displacement"
    assert api.get(f"creatures/{upload(linear)}/stroke.json").json() is None


BODY = {"cells": 10, "steps": 20, "viscosity": 0.1}


def test_a_length_and_a_period_scale_a_body(api):
    asked = {"length": "1 mm", "period": "0.5 s"}
    found = api.get("units", params=asked | BODY).json()
    assert (found["length"], found["period"], found["wrong"]) == (1e-3, 0.5, [])
    scales = found["scales"]
    # Ten cells of 0.1 mm, twenty steps of 25 ms: a length in 1,000 steps is 1 mm in 25 s.
    assert scales.pop("fluid").startswith("less than common liquids")
    expected = {"cell": 1e-4, "step": 0.025, "speed": 4e-5, "viscosity": 0.1 * 1e-8 / 0.025}
    # Re ν / L
    expected |= {"node_speed": expected["viscosity"] / 1e-3}
    assert scales == pytest.approx(expected)
    assert api.get("units", params=asked).json()["scales"] is None


@pytest.mark.parametrize("wrong", ["1", "mm", "0 mm", "-1 mm", "1..2 mm", "1 s", "1e200m"])
def test_what_is_no_quantity_is_named_and_is_no_error(api, wrong):
    answer = api.get("units", params={"length": wrong, "period": "20ms"} | BODY)
    assert answer.status_code == 200
    found = {"length": None, "period": 0.02, "wrong": ["length"], "scales": None}
    assert answer.json() == found


def test_nothing_typed_is_nothing_wrong(api):
    found = api.get("units", params={"length": "", "period": ""}).json()
    assert found == {"length": None, "period": None, "wrong": [], "scales": None}
