"""The curves, and what else generations tell."""

import json

import pytest

from server.attempts.claim import claim


@pytest.fixture
def told(services, run_id, report):
    """Twelve generations, of which every fifth tells a score."""
    attempt = claim(services, run_id, "worker")
    for generation in range(1, 13):
        summary = {"inserted": generation, "ended": "never", "fine": True}
        if generation % 5 == 0:
            summary["corrected"] = 0.5 * generation
        attempt.record(report(generation, summary=summary), 1.0)


def test_all_generations_tell_the_numbers_of_their_summaries(api, run_id, told):
    curves = api.get(f"runs/{run_id}/generations").json()
    assert curves["generation"] == list(range(1, 13))
    assert list(curves["summary"]) == ["inserted", "corrected"]
    assert curves["summary"]["inserted"] == curves["generation"]
    known = dict(zip(curves["generation"], curves["summary"]["corrected"], strict=True))
    assert {g: value for g, value in known.items() if value is not None} == {5: 2.5, 10: 5.0}


def test_thinned_curves_lose_nothing_that_is_told_now_and_then(api, run_id, told):
    curves = api.get(f"runs/{run_id}/generations", params={"points": 3}).json()
    assert curves["generation"] == [1, 7, 12]
    assert curves["summary"] == {"inserted": [1, 7, 12], "corrected": [None, 2.5, 5.0]}


def test_runs_that_tell_nothing_else_have_no_other_columns(api, services, run_id, report):
    claim(services, run_id, "worker").record(report(1), 1.0)
    assert api.get(f"runs/{run_id}/generations").json()["summary"] == {}


def test_a_generation_is_told_with_its_summary(services, run_id, told):
    entries = services.redis.xrange(services.events.stream)
    events = [json.loads(e[b"data"]) for _, e in entries if e[b"event"] == b"generation"]
    assert [event["summary"].get("corrected") for event in events[3:6]] == [None, 2.5, None]


def test_a_run_that_ended_early_is_done(api, services, run_id, report):
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1, summary={"ended": "fitness after generation 1"}), 1.0)
    attempt.save(1, b"the archive")
    attempt.finish()
    run = api.get(f"runs/{run_id}").json()
    assert (run["status"], run["progress"], run["generation"]) == ("finished", 1.0, 1)
