"""The length, stroke and sperm number of a creature, for its page."""

import numpy as np
import pytest
from answers import detail
from plans import FINS, ROOT, plan_identity


def sperm(steps, period):
    return (2 * np.pi * steps / period) ** 0.25


def test_a_grown_body_follows_its_actuators(api, upload):
    identity = plan_identity(ROOT, FINS)
    control = identity["genome"]["control"]
    answer = api.get(f"creatures/{upload(identity)}/stroke.json")
    assert "immutable" in answer.headers["cache-control"]
    found = answer.json()
    # A step leaves the share lag / (1 + lag) of what actuators lack; stiff joints lack nothing.
    slowest = 1 / np.log(1 + 1 / control["lag"])
    assert found["period"] == control["period"]
    assert found["sperm"] == pytest.approx(sperm(slowest, control["period"]), rel=1e-9)
    # The root has 8 edges; a fin of 4 at its middle gets no farther than its ends.
    assert found["length"] == pytest.approx(8 * identity["body"]["spacing"])


def test_a_softer_plan_has_a_larger_number(api, upload):
    identity = plan_identity(ROOT, FINS | {"stiffness": 0.5})
    control = identity["genome"]["control"] | {"softest": 0.01, "lag": 0}
    identity["genome"]["control"] = control
    found = api.get(f"creatures/{upload(identity)}/stroke.json").json()
    # A gene of ½ is the root of the softest: a step removes 0.1 of a joint's error.
    slowest = -1 / np.log(1 - 0.1)
    assert found["sperm"] == pytest.approx(sperm(slowest, found["period"]), rel=1e-6)


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


def test_a_creature_without_a_stroke_says_why(api, upload, identity):
    linear = identity(2)
    linear["genome"]["control"]["timer"] = "linear"
    linear["genome"]["inputs"] = ["position", "time"]
    linear["task"]["fitness"] = "displacement"
    said = detail(api.get(f"creatures/{upload(linear)}/stroke.json"), 404)
    assert "`control.timer` must repeat a stroke, got 'linear'" in said
