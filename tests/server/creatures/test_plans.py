"""The body plan of a creature."""

from answers import detail
from plans import FINS, ROOT, plan_identity


def test_a_plan_has_nodes_edges_and_segments(api, upload):
    sha = upload(plan_identity(ROOT, FINS))
    answer = api.get(f"creatures/{sha}/plan.json")
    assert "immutable" in answer.headers["cache-control"]
    drawn = answer.json()
    assert [segment["grown"] for segment in drawn["segments"]] == [1, 2]
    assert len(drawn["edges"]) == len(drawn["nodes"]) - 1 == 16
    assert drawn["nodes"][0].keys() == {"x", "y", "segment", "copy", "hand", "side"}


def test_a_creature_without_plan_says_so(api, known):
    assert "'cppn'" in detail(api.get(f"creatures/{known}/plan.json"), 404)
