"""A finished run takes more generations and goes on from its last checkpoint."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from server.attempts.claim import claim


def end(services, run_id, report, generations, summary=None):
    """Carry a run out up to a generation and finish it."""
    attempt = claim(services, run_id, "worker")
    for generation in range(attempt.generation + 1, generations + 1):
        attempt.record(report(generation, {generation: 1.0}, summary=summary), 1.0)
    attempt.save(generations, b"state after %d" % generations)
    attempt.finish()


def test_a_finished_run_is_queued_again_and_goes_on_where_it_ended(
    api, services, run_id, report, flush, row
):
    end(services, run_id, report, 400)
    flush()
    answer = api.post(f"runs/{run_id}/extend", json={"generations": 3})
    assert answer.status_code == 202
    run = answer.json()
    assert (run["status"], run["generation"], run["generations"]) == ("queued", 400, 403)
    assert run["spec"]["search"]["generations"] == 403
    assert run["finished_at"] is None
    assert services.jobs.runs.get_job_ids() == [str(run_id)]
    attempt = claim(services, run_id, "worker")
    assert (attempt.generation, attempt.restore()) == (400, b"state after 400")
    assert attempt.spec["search"]["generations"] == 403
    attempt.record(report(401), 1.0)
    assert len(api.get(f"runs/{run_id}/generations").json()["generation"]) == 401
    texts = [entry["text"] for entry in api.get(f"runs/{run_id}/log").json()["entries"]]
    assert "Extended by 3 generations to 403: queued again." in texts


@pytest.mark.postgresql
def test_of_two_that_extend_at_once_one_is_told_that_it_is_queued(
    api, services, run_id, report, row
):
    end(services, run_id, report, 2)
    with ThreadPoolExecutor(8) as pool:
        asked = [pool.submit(extended, api, run_id) for _ in range(8)]
        answers = [future.result() for future in asked]
    assert sorted(answer.status_code for answer in answers) == [202] + 7 * [409]
    assert row().generations == 401
    refused = next(answer for answer in answers if answer.status_code == 409)
    assert refused.json()["detail"] == "to extend a run it must be finished; it is queued"


def extended(api, run_id, generations=1):
    return api.post(f"runs/{run_id}/extend", json={"generations": generations})


def test_only_a_finished_run_is_extended(api, services, run_id):
    answer = extended(api, run_id)
    assert answer.status_code == 409
    assert answer.json()["detail"] == "to extend a run it must be finished; it is queued"


def test_a_run_that_its_goal_ended_would_end_there_again(api, services, run_id, report):
    end(services, run_id, report, 2, summary={"ended": "fitness after generation 2"})
    answer = extended(api, run_id)
    assert answer.status_code == 409
    assert "(fitness after generation 2)" in answer.json()["detail"]


def test_what_has_no_generations_to_add_says_so(api, services, sweep_id):
    claim(services, sweep_id, "worker").finish()
    answer = extended(api, sweep_id)
    assert answer.status_code == 409
    assert answer.json()["errors"][0]["field"] == "search.generations"


def test_how_many_is_checked(api, services, run_id, report, row):
    end(services, run_id, report, 1)
    for sent in ({"generations": 0}, {"generations": "many"}, {}, {"more": 1}):
        answer = api.post(f"runs/{run_id}/extend", json=sent)
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["field"] in ("generations", "more")
    answer = extended(api, run_id, 1_000_000)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == "search.generations"
    assert row().generations == 400


def test_everybody_is_told(api, services, run_id, report):
    end(services, run_id, report, 1)
    before = services.redis.xlen(services.events.stream)
    extended(api, run_id)
    told = services.redis.xrange(services.events.stream)[before:]
    assert [fields[b"event"] for _, fields in told] == [b"run"]
    assert b'"status": "queued"' in told[0][1][b"data"]
    assert b'"generations": 401' in told[0][1][b"data"]
