"""Sweeps: order in the queue, estimates, lists, and actions on all runs."""

from datetime import UTC, datetime
from uuid import UUID

import pytest
from sqlalchemy import delete

from microcosmos_server.auth import tokens
from microcosmos_server.maintenance.reconcile import delete_empty_sweeps, reconcile
from microcosmos_server.tables import Run


def test_runs_resumed_together_keep_their_order(runs_of, update_rows, post, waiting):
    sweep = post(seeds=30).json()
    update_rows(Run, queued_at=datetime(2026, 1, 1, tzinfo=UTC))
    assert waiting() == runs_of(sweep)


def test_an_estimate_is_of_all_runs_together(api, spec):
    one = api.post("runs/estimate", json=spec).json()
    asked = {"spec": spec, "seeds": 3, "grid": {"search.batch": [16, 32]}}
    found = api.post("sweeps/estimate", json=asked).json()
    assert (found["runs"], found["cases"]) == (6, 2)
    assert found["evaluations"] == 3 * (one["evaluations"] + 2 * one["evaluations"])
    larger = {**spec, "search": {**spec["search"], "batch": 32}}
    needed = api.post("runs/estimate", json=larger).json()
    assert found["memory_bytes"] == needed["memory_bytes"] > one["memory_bytes"]
    assert (found["seconds"], found["speed"]) == (None, None)
    assert api.get("runs").json()["items"] == []


def test_an_estimate_adds_up_the_seconds_of_runs_that_were_measured(
    claimed, api, run_id, report, spec
):
    attempt = claimed(run_id)
    attempt.record_device("cpu, a device, jaxlib 1")
    for generation in (1, 2, 3):
        attempt.record(report(generation), 2.0)
    one = api.post("runs/estimate", json=spec).json()["seconds"]
    found = api.post("sweeps/estimate", json={"spec": spec, "seeds": 5}).json()
    assert found["seconds"] == pytest.approx(5 * one)


def test_a_list_has_runs_of_one_sweep_or_of_none(runs_of, api, post, spec, six):
    other = post(seeds=2).json()
    single = api.post("runs", json=spec).json()["id"]
    assert len(runs_of(six)) == 6
    assert runs_of(other) == other["cases"][0]["runs"]
    alone = api.get("runs", params={"sweep": "none"}).json()["items"]
    assert [run["id"] for run in alone] == [single]
    assert api.get("runs", params={"sweep": "x"}).status_code == 422


def test_actions_on_a_sweep_list_skipped_runs(runs_of, claimed, api, waiting, six, report):
    queued = waiting
    first, second, *waiting = map(UUID, runs_of(six))
    done, busy = claimed(first, "one"), claimed(second, "two")
    done.record(report(1), 1.0)
    done.finish()
    answer = api.post(f"sweeps/{six['id']}/pause")
    paused = answer.json()
    assert answer.status_code == 202
    assert paused["status_counts"] == {"running": 1, "paused": 4, "finished": 1}
    assert paused["changed"] == [str(run) for run in (second, *waiting)]
    (left,) = paused["skipped"]
    assert (left["run"], left["status"]) == (str(first), "finished")
    assert "it is finished" in left["reason"]
    assert api.get(f"runs/{second}").json()["requested_state"] == "paused"
    busy.pause()
    resumed = api.post(f"sweeps/{six['id']}/resume").json()
    assert resumed["status_counts"] == {"queued": 5, "finished": 1}
    assert queued() == [*map(str, (second, *waiting))]
    cancelled = api.post(f"sweeps/{six['id']}/cancel").json()
    assert cancelled["status_counts"] == {"finished": 1, "cancelled": 5}
    assert cancelled["progress"] == pytest.approx(1 / 6)
    again = api.post(f"sweeps/{six['id']}/cancel").json()
    assert (again["changed"], len(again["skipped"])) == ([], 6)
    some = {"runs": [str(first), *cancelled["changed"][1:]]}
    back = api.post(f"sweeps/{six['id']}/uncancel", json=some).json()
    assert back["status_counts"] == {"finished": 1, "cancelled": 1, "queued": 4}
    assert back["changed"] == some["runs"][1:]
    assert [one["run"] for one in back["skipped"]] == [str(first)]


def test_runs_beyond_a_quota_stay_paused_with_the_reason(api, services, six, update_rows):
    owner = tokens.create(services, "anne", "write", max_queued=4).token.id
    update_rows(Run, owner=owner, status="paused")
    resumed = api.post(f"sweeps/{six['id']}/resume").json()
    assert resumed["status_counts"] == {"queued": 4, "paused": 2}
    words = "`anne` may have 4 queued runs; it has 4, and this request adds 1."
    assert [one["reason"] for one in resumed["skipped"]] == [words] * 2


def test_a_sweep_has_a_name_that_can_be_changed(api, six):
    runs = [run["name"] for run in api.get("runs").json()["items"]]
    for sent, name in (({"name": " Thick "}, "Thick"), ({"name": ""}, None)):
        answer = api.patch(f"sweeps/{six['id']}", json=sent)
        assert (answer.status_code, answer.json()["name"]) == (200, name)
        assert api.get(f"sweeps/{six['id']}").json() == {**six, "name": name}
    assert [run["name"] for run in api.get("runs").json()["items"]] == runs
    for sent in ({}, {"name": "x" * 201}, {"name": 1}, {"spec": {}}):
        assert api.patch(f"sweeps/{six['id']}", json=sent).status_code == 422
    assert api.patch(f"sweeps/{UUID(int=5)}", json={"name": "x"}).status_code == 404


def test_a_deleted_sweep_is_hidden_and_restored_unchanged(runs_of, claimed, api, services, six):
    path = f"sweeps/{six['id']}"
    first, *others = runs_of(six)
    attempt = claimed(first)
    refused = api.delete(path).json()
    assert (refused["changed"], len(refused["skipped"])) == ([], 6)
    api.post(f"{path}/cancel")
    before = api.get(path).json()
    deleted = api.delete(path).json()
    assert (deleted["changed"], deleted["skipped"][0]["run"]) == (others, first)
    assert (deleted["total"], deleted["deleted"]) == (1, 5)
    attempt.cancel()
    api.delete(path)
    assert api.get("sweeps").json()["items"] == api.get("runs").json()["items"] == []
    whole = api.get(path).json()
    assert [case["runs"] for case in whole.pop("cases")] == [[], []]
    assert api.get("sweeps", params={"deleted": True}).json()["items"] == [whole]
    empty = api.get(f"{path}/summary").json()["cases"]
    assert [(case["members"], case["generation"]) for case in empty] == 2 * [([], [])]
    reconcile(services)
    assert set(api.post(f"{path}/restore").json()["changed"]) == {first, *others}
    assert api.get(path).json() == {**before, "status_counts": {"cancelled": 6}}


def test_a_sweep_ends_with_the_last_of_its_runs(api, services, six):
    delete_empty_sweeps(services)
    assert api.get(f"sweeps/{six['id']}").status_code == 200
    with services.sessions.write.begin() as session:
        session.execute(delete(Run).where(Run.sweep == UUID(six["id"])))
    delete_empty_sweeps(services)
    assert api.get(f"sweeps/{six['id']}").status_code == 404
