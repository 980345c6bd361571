"""Sweeps: order in the queue, estimates, lists, and actions on all runs."""

from datetime import UTC, datetime
from uuid import UUID

import httpx
import pytest
from sqlalchemy import delete, update

from server.maintenance.reconcile import delete_empty_sweeps, reconcile
from server.tables import Run


def test_single_runs_are_taken_before_those_of_a_sweep(runs_of, api, waiting, six, spec):
    single = api.post("runs", json=spec).json()["id"]
    ids = runs_of(six)
    assert waiting() == [single, *ids]
    assert api.post("runs/estimate", json=spec).json()["queue"]["runs_ahead"] == 1
    both = api.post("sweeps/estimate", json={"spec": spec}).json()["queue"]["runs_ahead"]
    assert both == 7


def test_runs_resumed_together_keep_their_order(runs_of, services, post, waiting):
    sweep = post(seeds=30).json()
    with services.sessions.write.begin() as session:
        session.execute(update(Run).values(queued_at=datetime(2026, 1, 1, tzinfo=UTC)))
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
    claimed, api, services, run_id, report, spec
):
    attempt = claimed(run_id)
    with services.sessions.write.begin() as session:
        session.get_one(Run, run_id).device = "cpu, a device, jaxlib 1"
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


def test_sweeps_are_listed_in_pages_newest_first(api, post):
    ids = [post(name=f"{i}").json()["id"] for i in range(3)]
    first = api.get("sweeps", params={"limit": 2}).json()
    assert [sweep["id"] for sweep in first["items"]] == [ids[2], ids[1]]
    rest = api.get("sweeps", params={"limit": 2, "cursor": first["next"]}).json()
    assert ([sweep["id"] for sweep in rest["items"]], rest["next"]) == ([ids[0]], None)
    plain = httpx.get(f"{api.base_url}sweeps?limit=2&cursor={first['next']}")
    assert plain.json() == rest, "an address has it as it is"
    for cursor in ("x", "2026-01-01T00:00:00~x", "9999-99-99~" + ids[0]):
        assert api.get("sweeps", params={"cursor": cursor}).status_code == 422


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
    assert "cancel it first" in refused["skipped"][0]["reason"]
    api.post(f"{path}/cancel")
    before = api.get(path).json()
    deleted = api.delete(path)
    assert deleted.status_code == 200
    assert (deleted.json()["changed"], deleted.json()["skipped"][0]["run"]) == (others, first)
    assert (deleted.json()["total"], deleted.json()["deleted"]) == (1, 5)
    assert len(api.get("sweeps").json()["items"]) == 1
    attempt.cancel()
    api.delete(path)
    assert api.get("sweeps").json()["items"] == api.get("runs").json()["items"] == []
    (listed,) = api.get("sweeps", params={"deleted": True}).json()["items"]
    assert (listed["id"], listed["total"], listed["deleted"]) == (six["id"], 0, 6)
    assert api.get(path).json() == listed
    empty = api.get(f"{path}/summary").json()["cases"]
    assert [(case["members"], case["generation"], case["finals"]) for case in empty] == 2 * [
        ([], [], {})
    ]
    reconcile(services)
    restored = api.post(f"{path}/restore").json()
    assert set(restored["changed"]) == {first, *others}
    assert api.get(path).json() == {**before, "status_counts": {"cancelled": 6}}
    assert api.get("sweeps", params={"deleted": True}).json()["items"] == []
    assert api.post(f"{path}/restore").json()["changed"] == []


def test_changes_of_a_sweep_are_published(address, six, api, published):
    assert published()[-1] == ("sweep", {"sweep": six["id"]})
    api.post(f"sweeps/{six['id']}/cancel")
    kinds = [kind for kind, _ in published()]
    assert kinds == ["sweep", *["run"] * 6, "sweep"]


def test_an_unknown_sweep_is_not_found(address):
    unknown = f"{address}/api/v1/sweeps/{UUID(int=5)}"
    for path in ("", "/summary", "/curves"):
        assert httpx.get(unknown + path).status_code == 404
    assert httpx.post(f"{unknown}/cancel").status_code == 404


def test_a_sweep_ends_with_the_last_of_its_runs(api, services, six):
    delete_empty_sweeps(services)
    assert api.get(f"sweeps/{six['id']}").status_code == 200
    with services.sessions.write.begin() as session:
        session.execute(delete(Run).where(Run.sweep == UUID(six["id"])))
    delete_empty_sweeps(services)
    assert api.get(f"sweeps/{six['id']}").status_code == 404
