"""Submitting, listing, reading and steering runs, over HTTP."""

from concurrent.futures import ThreadPoolExecutor
from uuid import UUID

import pytest
from answers import detail, fields
from deletion import let_time_pass
from sqlalchemy import select
from sqlalchemy.exc import TimeoutError

from microcosmos_server.maintenance.reconcile import reconcile
from microcosmos_server.notifications import outbox
from microcosmos_server.runs import routes
from microcosmos_server.tables import Notification
from microcosmos_server.workers import registry

PROBLEM = "application/problem+json"


FINE = [{"name": name, "bins": 1024} for name in ("bending_effort", "stretching_effort")]


def changed(spec, path, value):
    *parts, last = path.split(".")
    part = spec
    for name in parts:
        part = part[name]
    part[last] = value
    return spec


def test_experiments_carry_schema_and_presets_that_can_be_submitted(api):
    experiments = api.get("experiments").json()
    names = [found["experiment"] for found in experiments]
    searches, others = ["quality-diversity", "neuroevolution"], ["gaits", "scaling"]
    assert names == [*searches, "folding", "refinement", *others]
    for found in experiments:
        assert set(found) == {"experiment", "title", "about", "schema", "presets"}
        assert found["schema"]["properties"]["experiment"]
        if found["experiment"] == "refinement":  # It begins at a creature.
            assert not found["presets"]
            continue
        assert {"demo", "paper"} <= {preset["name"] for preset in found["presets"]}
        for preset in found["presets"]:
            assert api.post("runs/estimate", json=preset["spec"]).status_code == 200


def test_a_submitted_run_is_queued(api, waiting, spec):
    answer = api.post("runs", json=spec)
    assert answer.status_code == 202
    run = answer.json()
    assert run["status"] == "queued"
    assert run["generations"] == spec["search"]["generations"]
    assert run["spec"] == spec
    assert answer.headers["location"] == f"/api/v1/runs/{run['id']}"
    assert waiting() == [run["id"]]
    assert api.get(f"runs/{run['id']}").json() == run


@pytest.mark.parametrize(
    ("path", "value", "field", "words"),
    [
        ("surprise", 1, "surprise", "no field of this name"),
        ("world.colour", "red", "world.colour", "no field of this name"),
        ("world.viscosity", -1, "world.viscosity", "greater than or equal to 0.001"),
        ("body.nodes", 10**9, "body.nodes", "less than or equal to 4096"),
        ("body.nodes", 48, "world.width", "at least 56 cells"),
        ("search.block", 4096, "search.block", "bytes of memory"),
        ("experiment", "x", "experiment", "quality-diversity"),
        ("seed", "one", "seed", "valid integer"),
    ],
)
def test_bad_input_is_refused_with_field_and_reason(api, spec, path, value, field, words):
    if path == "search.block":
        spec["world"] |= {"width": 1024, "height": 1024}
    answer = api.post("runs", json=changed(spec, path, value))
    assert answer.status_code == 422
    assert answer.headers["content-type"] == PROBLEM
    (error,) = answer.json()["errors"]
    assert error["field"] == field
    assert words in error["reason"]
    if "got" in error and path != "search.block":
        assert error["got"] == value
    assert api.get("runs").json()["items"] == []


@pytest.mark.parametrize(
    ("experiment", "change", "field"),
    [
        ("quality-diversity", {}, "search.block"),
        ("quality-diversity", {"search": {"batch": 65_536}}, "search.batch"),
        ("neuroevolution", {}, "search.block"),
        ("neuroevolution", {"search": {"batch": 65_536}}, "search.batch"),
        ("quality-diversity", {"archive": {"descriptors": FINE}}, "archive"),
        ("gaits", {}, "block"),
        ("scaling", {}, "nodes"),
        ("folding", {}, "memory"),
    ],
)
def test_a_run_that_needs_too_much_memory_names_the_field(
    api, services, experiment, change, field
):
    registry.report(services.sessions, "small", "cpu", 1000, "idle")
    assert fields(api.post("runs", json={"experiment": experiment, **change}))[0] == field


@pytest.mark.parametrize(
    ("body", "status", "words"),
    [
        (b"{", 422, "JSON is needed"),
        (b"[]", 422, "object is needed"),
        (b'{"seed": NaN}', 422, "finite"),
        (b'{"seed": 1e999}', 422, "finite"),
        (b'{"a":' + b"[" * 50 + b"]" * 50 + b"}", 422, "more than the 32 levels"),
        (b'{"a":' + b"[" * 100_000, 422, "more than the 32 levels"),
        (b"\xff\xfe", 422, "JSON is needed"),
        (b'{"experiment": "\\ud800"}', 422, "must be Unicode; got '\\ud800'"),
        (b'{"\\udfff": 1}', 422, "must be Unicode"),
        (b'{"body": {"kind": "\\u0000"}}', 422, "without NUL"),
        (b'"' + b"a" * (1 << 21) + b'"', 413, "more than the 1,048,576 bytes"),
    ],
)
def test_a_body_that_is_not_a_plain_object_is_refused(api, body, status, words):
    answer = api.post("runs", content=body)
    assert answer.status_code == status
    assert answer.headers["content-type"] == PROBLEM
    assert words in answer.json()["detail"]


def test_invalid_queries_and_missing_paths_answer_with_problems(api):
    assert api.get("runs", params={"cursor": "nonsense"}).status_code == 422
    assert fields(api.get("runs", params={"limit": 0}))[0] == "limit"
    for path in ("runs/00000000-0000-0000-0000-000000000000", "nothing"):
        answer = api.get(path)
        assert (answer.status_code, answer.headers["content-type"]) == (404, PROBLEM), path
    assert detail(api.get("runs/abc"), 422) == (
        "run_id: needs an id such as 1b4e28ba-2fa1-41d2-883f-0016d3cca427; got 'abc'"
    )


def test_a_run_must_fit_the_largest_live_worker(api, services, spec):
    needed = api.post("runs/estimate", json=spec).json()
    assert needed["memory_limit_bytes"] == services.settings.max_bytes
    registry.report(services.sessions, "small", "cpu", 1000, "idle")
    answer = api.post("runs", json=spec)
    assert f"{needed['memory_bytes']:,}" in detail(answer, 422)
    assert "1,000 bytes are available" in answer.json()["detail"]
    registry.report(services.sessions, "large", "cpu", needed["memory_bytes"], "idle")
    assert api.post("runs", json=spec).status_code == 202
    registry.report(services.sessions, "huge", "cpu", 1 << 50, "idle")
    capped = api.post("runs/estimate", json=spec).json()
    assert capped["memory_limit_bytes"] == services.settings.max_bytes


@pytest.mark.postgresql
def test_the_same_key_at_once_gives_one_run(api, waiting, spec):
    headers = {"Idempotency-Key": "a key"}
    with ThreadPoolExecutor(8) as pool:
        sent = [pool.submit(api.post, "runs", json=spec, headers=headers) for _ in range(8)]
    answers = [one.result() for one in sent]
    assert sorted(answer.status_code for answer in answers) == [200] * 7 + [202]
    assert len({answer.json()["id"] for answer in answers}) == 1
    assert len(api.get("runs").json()["items"]) == 1
    assert len(waiting()) == 1


def test_a_key_cannot_be_used_for_another_spec(api, spec):
    headers = {"Idempotency-Key": "a key"}
    run = api.post("runs", json=spec, headers=headers).json()
    assert run["id"] in detail(api.post("runs", json={**spec, "seed": 1}, headers=headers), 422)


def test_a_key_cannot_be_used_for_another_query(api, spec):
    asked = {"json": spec, "headers": {"Idempotency-Key": "a key"}}
    first = {"name": "first", "priority": "low", "device_patience": 60.0}
    run = api.post("runs", **asked, params=first).json()
    assert api.post("runs", **asked, params=first).json()["id"] == run["id"]
    others = {
        "name": "second",
        "priority": "normal",
        "device_patience": 61.0,
        "labels": ["large"],
        "may_yield": True,
    }
    for field, value in others.items():
        answer = api.post("runs", **asked, params={**first, field: value})
        assert run["id"] in detail(answer, 422), field
    assert api.get(f"runs/{run['id']}").json()["name"] == "first"


@pytest.mark.parametrize("before", ["queued", "paused"])
def test_a_cancelled_run_is_again_what_it_was(api, run_id, row, before):
    run = f"runs/{run_id}"
    if before == "paused":
        api.post(f"{run}/pause")
    queued_at = row().queued_at
    assert api.post(f"{run}/cancel").json()["status"] == "cancelled"
    back = api.post(f"{run}/uncancel").json()
    assert (back["status"], back["finished_at"]) == (before, None)
    assert row().queued_at == queued_at, "it keeps its place"
    refused = detail(api.post(f"{run}/uncancel"), 409)
    assert "it must be cancelled, or about to be" in refused
    api.post(f"{run}/cancel")
    api.delete(run)
    assert api.post(f"{run}/uncancel").status_code == 404, "it is in the bin"


def test_a_run_that_a_worker_stopped_is_queued_first(api, run_id, attempt, row):
    api.post(f"runs/{run_id}/cancel")
    attempt.cancel()
    assert row().status == "cancelled"
    api.post(f"runs/{run_id}/uncancel")
    assert (row().status, row().interrupted, row().finished_at) == ("queued", True, None)
    assert row().worker is None, "any worker may take it"


@pytest.mark.parametrize("seen", ["nothing", "request", "undo"])
def test_a_cancellation_that_is_taken_back_leaves_a_requested_pause(
    api, run_id, attempt, row, seen
):
    run = f"runs/{run_id}"
    api.post(f"{run}/pause")
    for _ in range(2):  # The second request changes nothing.
        assert api.post(f"{run}/cancel").json()["requested_state"] == "cancelled"
    if seen == "request":
        attempt.cancel()
    back = api.post(f"{run}/uncancel").json()
    if seen == "nothing":
        assert (back["status"], back["requested_state"]) == ("running", "paused")
        attempt.pause()
    if seen == "undo":  # The worker has looked before it.
        attempt.cancel()
    assert (row().status, row().requested_state, row().worker) == ("paused", None, None)
    assert (row().finished_at, row().interrupted) == (None, False)


def test_an_undone_cancellation_is_told_to_nobody(api, services, run_id):
    def waiting():
        with services.sessions.read() as session:
            return [one.kind for one in session.scalars(select(Notification))]

    api.post(f"runs/{run_id}/cancel")
    assert waiting() == ["run.cancelled"]
    assert outbox.take(services) is None, "it waits for an undo"
    api.post(f"runs/{run_id}/uncancel")
    assert waiting() == []


def test_a_key_says_that_its_run_was_deleted(api, services, spec):
    asked = {"json": spec, "headers": {"Idempotency-Key": "a key"}}
    run = api.post("runs", **asked).json()["id"]
    api.post(f"runs/{run}/cancel")
    api.delete(f"runs/{run}")
    assert f"for run {run}, which is in the bin: restore it" in detail(
        api.post("runs", **asked), 410
    )
    let_time_pass(services, UUID(run))
    reconcile(services)
    assert "that was deleted: use another key" in detail(api.post("runs", **asked), 410)
    assert api.get("runs").json()["items"] == []


def test_keys_work_with_integers_beyond_canonical_json(api, spec):
    spec["search"]["stop"] = {"evaluations": 2**53 + 1}
    headers = {"Idempotency-Key": "large"}
    first, second = (api.post("runs", json=spec, headers=headers) for _ in range(2))
    assert (first.status_code, second.status_code) == (202, 200)
    assert first.json()["id"] == second.json()["id"]
    spec["search"]["stop"]["evaluations"] += 1
    assert api.post("runs", json=spec, headers=headers).status_code == 422


def test_an_accepted_key_is_not_refused_later(api, services, spec):
    """A worker with the memory may have gone meanwhile."""
    headers = {"Idempotency-Key": "a key"}
    registry.report(services.sessions, "large", "cpu", 1 << 29, "idle")
    first = api.post("runs", json=spec, headers=headers)
    registry.report(services.sessions, "large", "cpu", 1000, "idle")
    assert api.post("runs", json=spec).status_code == 422
    assert api.post("runs", json=spec, headers=headers).json()["id"] == first.json()["id"]


def test_a_database_without_a_free_connection_is_unavailable(api, run_id, monkeypatch):
    def exhausted(*_):
        raise TimeoutError("QueuePool limit reached")

    monkeypatch.setattr(routes, "read_run", exhausted)
    answer = api.get(f"runs/{run_id}")
    assert (answer.status_code, answer.headers["content-type"]) == (503, PROBLEM)
