"""Many runs by one request: all or none of them, steered and summed up together."""

import json
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from uuid import UUID

import httpx
import numpy as np
import pytest
from sqlalchemy import delete, event, insert, select, update

from microcosmos.archive import creature
from server.attempts.begin import claim
from server.attempts.claim import Claim
from server.estimates.position import in_line
from server.maintenance.reconcile import forget_empty_sweeps, reconcile
from server.sweeps import submission
from server.sweeps.summary import summary
from server.tables import Generation, Run, Sweep

VISCOSITIES = {"world.viscosity": [0.05, 0.1]}


@pytest.fixture
def post(api, spec):
    """Submits a sweep of the small search."""

    def send(**asked):
        return api.post("sweeps", json={"spec": spec, **asked})

    return send


@pytest.fixture
def six(post):
    """Two viscosities with three seeds each."""
    return post(seeds=3, grid=VISCOSITIES, name="thick and thin").json()


def claimed(services, run: str | UUID, worker="worker") -> Claim:
    found = claim(services, UUID(str(run)), worker)
    assert found
    return found


def runs_of(api, sweep):
    found = api.get("runs", params={"sweep": sweep["id"], "sort": "created"}).json()["items"]
    return [run["id"] for run in found]


def test_a_sweep_is_each_case_with_each_seed_the_first_seed_first(api, services, six):
    assert (six["total"], six["status_counts"], six["progress"]) == (6, {"queued": 6}, 0)
    assert [case["values"] for case in six["cases"]] == [
        {"world.viscosity": 0.05},
        {"world.viscosity": 0.1},
    ]
    found = api.get("runs", params={"sweep": six["id"], "sort": "created"}).json()["items"]
    told = [(run["spec"]["world"]["viscosity"], run["spec"]["seed"]) for run in found]
    assert told == [(nu, seed) for seed in (0, 1, 2) for nu in (0.05, 0.1)]
    assert found[3]["name"] == "thick and thin · world.viscosity=0.1 · seed 1"
    assert {run["sweep"] for run in found} == {six["id"]}
    ids = [run["id"] for run in found]
    assert [case["runs"] for case in six["cases"]] == [ids[::2], ids[1::2]]
    assert services.jobs.sweeps.get_job_ids() == ids
    assert api.get(f"sweeps/{six['id']}").json() == six


def test_a_number_of_seeds_goes_on_from_the_specs_own(api, post, spec):
    spec["seed"] = 7
    assert post(seeds=3).json()["seeds"] == [7, 8, 9]
    assert post(seeds=[4, 2]).json()["seeds"] == [4, 2]
    assert post().json()["total"] == 1


def test_a_path_reaches_into_lists_and_a_value_may_be_a_whole_part(api, post):
    grid = {"archive.descriptors.0.bins": [4, 8], "body": [{"builder": "ring", "nodes": 8}]}
    found = post(grid=grid).json()
    specs = [api.get(f"runs/{case['runs'][0]}").json()["spec"] for case in found["cases"]]
    assert [one["archive"]["descriptors"][0]["bins"] for one in specs] == [4, 8]
    assert {one["archive"]["descriptors"][1]["bins"] for one in specs} == {16}
    assert {one["body"]["builder"] for one in specs} == {"ring"}


def test_a_part_that_is_off_can_be_given_fields(api, post):
    found = post(grid={"world.energy.packets": [2, 3]}).json()
    specs = [api.get(f"runs/{case['runs'][0]}").json()["spec"] for case in found["cases"]]
    assert [one["world"]["energy"]["packets"] for one in specs] == [2, 3]


@pytest.mark.parametrize(
    ("asked", "field", "words"),
    [
        ({"grid": {"world.viscosity": [0.1, 0.2, -1]}}, "grid.world.viscosity[2]", "0.001"),
        ({"grid": {"world.viscosti": [1]}}, "grid.world.viscosti", "`world.viscosity`"),
        ({"grid": {"viscosity": [1]}}, "grid.viscosity", "did you mean `world.viscosity`"),
        ({"grid": {"archive.descriptors.2.bins": [4]}}, "grid.archive.descriptors.2.bins", ""),
        ({"grid": {"seed": [1]}}, "grid.seed", "`seeds`"),
        ({"grid": {"experiment": ["folding"]}}, "grid.experiment", "one experiment"),
        ({"grid": {"seed.low": [1]}}, "grid.seed.low", "no field"),
        ({"grid": {"world.viscosity": []}}, "grid.world.viscosity", "at least 1 item"),
        ({"grid": {"world.viscosity": [1, 1.0]}}, "grid.world.viscosity[1]", "viscosity[0]"),
        ({"grid": {"world": [{}], "world.width": [64]}}, "grid.world.width", "lies in `world`"),
        ({"grid": {"body.nodes": [8, 512]}}, "grid.body.nodes[1]", "with body.nodes=512"),
        (
            {"grid": {"body.nodes": [8, 64], "world.width": [64, 128]}},
            "grid",
            "with body.nodes=64, world.width=64: `world.height` must be at least 80",
        ),
        (
            {"grid": {"world.height": [128], "body.nodes": [8, 99], "world.width": [64, 128]}},
            "grid.world.width[0]",
            "with world.height=128, body.nodes=99, world.width=64: `world.width` must",
        ),
        ({"grid": {"world.energy.colour": [1]}}, "grid.world.energy.colour[0]", "no field"),
        ({"seeds": 0}, "seeds", "from 1 to 1,000"),
        ({"seeds": [1, 2, 1]}, "seeds", "got 1 more than once"),
        ({"seeds": [-1]}, "seeds", "whole numbers"),
        ({"seeds": "many"}, "seeds", "whole numbers"),
        ({"seeds": True}, "seeds", "whole numbers"),
        ({"seeds": 1001}, "seeds", "from 1 to 1,000"),
        ({"seeds": 501, "grid": VISCOSITIES}, "grid", "got 2 x 501 = 1,002"),
        (
            {"grid": {"world.viscosity": [10**20], "body.nodes": [512]}},
            "grid.world.viscosity[0]",
            "",
        ),
        ({"grid": {"world.width": [10**20, "x"]}}, "grid.world.width[1]", "valid integer"),
        ({"surprise": 1}, "surprise", "no field of this name"),
        ({"name": "x" * 201}, "name", "200"),
    ],
)
def test_nothing_is_written_where_any_run_could_not_be(api, post, asked, field, words):
    answer = post(**asked)
    assert answer.status_code == 422
    problem = answer.json()
    assert field in [error["field"] for error in problem["errors"]]
    assert words in problem["detail"]
    assert api.get("sweeps").json()["items"] == []
    assert api.get("runs").json()["items"] == []


def test_a_spec_that_is_wrong_by_itself_is_told_as_such(api, spec):
    spec["world"]["viscosity"] = -1
    (error,) = api.post("sweeps", json={"spec": spec}).json()["errors"]
    assert error["field"] == "spec.world.viscosity"
    spec["world"]["viscosity"], spec["seed"] = 0.1, 2**32 - 1
    (error,) = api.post("sweeps", json={"spec": spec, "seeds": 2}).json()["errors"]
    assert (error["field"], "seeds end at 4294967296" in error["message"]) == ("seeds", True)


def test_memory_is_refused_at_the_value_that_asks_for_it(api, post, spec):
    spec["archive"]["descriptors"][1]["bins"] = 1024
    grid = {"archive.descriptors.0.bins": [16, 900, 1000], **VISCOSITIES}
    answer = post(grid=grid)
    problem = answer.json()
    assert (answer.status_code, problem["title"]) == (422, "More memory than there is")
    fields = [error["field"] for error in problem["errors"]]
    assert fields == [f"grid.archive.descriptors.0.bins[{place}]" for place in (1, 2)]
    assert "with archive.descriptors.0.bins=900, world.viscosity=0.05" in problem["detail"]
    assert api.get("runs").json()["items"] == []


def test_a_write_that_fails_half_way_leaves_nothing(services, post, monkeypatch):
    def fail(*_):
        raise RuntimeError("half way")

    monkeypatch.setattr(submission, "_first_entry", fail)
    assert post(seeds=3).status_code == 500
    with services.sessions.read() as session:
        assert not session.scalars(select(Run.id)).all()
        assert not session.scalars(select(Sweep.id)).all()


@pytest.mark.postgresql
def test_the_same_key_at_once_gives_one_sweep(api, services, spec):
    headers = {"Idempotency-Key": "a key"}
    asked = {"spec": spec, "seeds": 2}
    with ThreadPoolExecutor(4) as pool:
        answers = list(
            pool.map(lambda _: api.post("sweeps", json=asked, headers=headers), range(4))
        )
    assert sorted(answer.status_code for answer in answers) == [200] * 3 + [202]
    assert len({answer.json()["id"] for answer in answers}) == 1
    assert services.jobs.sweeps.count == 2
    for path, other in (("sweeps", {**asked, "seeds": 3}), ("runs", spec)):
        refused = api.post(path, json=other, headers=headers)
        assert (refused.status_code, refused.json()["title"]) == (422, "Idempotency key reused")
        assert f"sweep {answers[0].json()['id']}" in refused.json()["detail"]


def test_whole_numbers_that_canonical_json_has_not_are_no_hindrance(api, spec):
    asked = {"spec": spec, "grid": {"search.stop.evaluations": [10**20, 10**21]}}
    answer = api.post("sweeps", json=asked, headers={"Idempotency-Key": "large"})
    assert answer.status_code == 202
    run = api.get(f"runs/{answer.json()['cases'][0]['runs'][0]}").json()
    assert run["spec"]["search"]["stop"]["evaluations"] == 10**20


@pytest.fixture
def elite(services, run_id, report, identity):
    """The name of a creature that lives in a finished run."""
    attempt = claimed(services, run_id)
    attempt.record(report(1, {0: 1.0}), 1.0)
    attempt.finish()
    return creature.name(identity(1000))


def test_what_a_sweep_begins_from_stays_as_long_as_its_runs(
    api, services, post, spec, run_id, elite
):
    spec["search"]["origin"] = [elite]
    sweep = post(seeds=2, grid=VISCOSITIES).json()
    api.delete(f"runs/{run_id}")
    with services.sessions.write.begin() as session:
        session.get_one(Run, run_id).purge_at = session.get_one(Run, run_id).deleted_at
    reconcile(services)
    assert api.get(f"runs/{run_id}").status_code == 404
    assert api.get(f"creatures/{elite}").status_code == 200
    for run in runs_of(api, sweep):
        (file,) = claimed(services, run).origin()
        assert file["sha256"] == elite


@pytest.mark.parametrize(
    ("asked", "origin", "field"),
    [
        ({}, "ab" * 32, "spec.search.origin"),
        ({"grid": {"search.origin": [[], ["ab" * 32]]}}, None, "grid.search.origin[1]"),
        ({"grid": {"control.timer": ["linear"], **VISCOSITIES}}, None, "spec.control: inputs"),
    ],
)
def test_a_sweep_that_could_not_begin_is_refused(api, post, spec, elite, asked, origin, field):
    spec["search"]["origin"] = [origin or elite]
    answer = post(**asked)
    assert (answer.status_code, answer.json()["errors"][0]["field"]) == (422, field)
    assert len(api.get("runs").json()["items"]) == 1


def test_single_runs_are_taken_before_those_of_a_sweep(api, services, six, spec):
    single = api.post("runs", json=spec).json()["id"]
    ids = runs_of(api, six)
    with services.sessions.read() as session:
        assert [str(one.run) for one in in_line(session)] == [single, *ids]
    assert [queue.get_job_ids() for queue in services.jobs.evolving] == [[single], ids]
    assert api.post("runs/estimate", json=spec).json()["queue"]["runs_ahead"] == 1
    both = api.post("sweeps/estimate", json={"spec": spec}).json()["queue"]["runs_ahead"]
    assert both == 7


def test_runs_that_are_resumed_together_wait_in_their_old_order(services, post, api):
    sweep = post(seeds=30).json()
    with services.sessions.write.begin() as session:
        session.execute(update(Run).values(queued_at=datetime(2026, 1, 1, tzinfo=UTC)))
    with services.sessions.read() as session:
        waiting = [str(one.run) for one in in_line(session)]
    assert waiting == runs_of(api, sweep)


def test_runs_of_a_sweep_are_enqueued_again_where_redis_forgot_them(services, six, flush, api):
    flush()
    reconcile(services)
    assert services.jobs.sweeps.get_job_ids() == runs_of(api, six)
    assert services.jobs.runs.count == 0


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
    api, services, run_id, report, spec
):
    attempt = claimed(services, run_id)
    with services.sessions.write.begin() as session:
        session.get_one(Run, run_id).device = "cpu, a device, jaxlib 1"
    for generation in (1, 2, 3):
        attempt.record(report(generation), 2.0)
    one = api.post("runs/estimate", json=spec).json()["seconds"]
    found = api.post("sweeps/estimate", json={"spec": spec, "seeds": 5}).json()
    assert found["seconds"] == pytest.approx(5 * one)


def test_a_list_has_runs_of_one_sweep_or_of_none(api, post, spec, six):
    other = post(seeds=2).json()
    single = api.post("runs", json=spec).json()["id"]
    assert len(runs_of(api, six)) == 6
    assert runs_of(api, other) == other["cases"][0]["runs"]
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


def test_who_steers_a_sweep_is_told_which_runs_were_left_alone(api, services, six, report):
    first, second, *waiting = map(UUID, runs_of(api, six))
    done, busy = claimed(services, first, "one"), claimed(services, second, "two")
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
    assert set(map(str, (second, *waiting))) <= set(services.jobs.sweeps.get_job_ids())
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


def test_a_deleted_sweep_is_out_of_sight_and_comes_back_as_it_was(api, services, six):
    path = f"sweeps/{six['id']}"
    first, *others = runs_of(api, six)
    attempt = claimed(services, first)
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


def test_what_happens_to_a_sweep_is_told_to_everybody(address, services, six, api):
    newest = services.redis.xrevrange(services.events.stream, count=1)[0][1]
    assert (newest[b"event"], json.loads(newest[b"data"])) == (b"sweep", {"sweep": six["id"]})
    api.post(f"sweeps/{six['id']}/cancel")
    told = services.redis.xrange(services.events.stream)
    kinds = [entry[b"event"] for _, entry in told]
    assert kinds == [b"sweep", *[b"run"] * 6, b"sweep"]


def test_an_unknown_sweep_is_not_found(address):
    unknown = f"{address}/api/v1/sweeps/{UUID(int=5)}"
    for path in ("", "/summary", "/curves"):
        assert httpx.get(unknown + path).status_code == 404
    assert httpx.post(f"{unknown}/cancel").status_code == 404


def test_bands_are_the_quartiles_of_the_runs_that_have_got_so_far(api, services, post):
    sweep = post(seeds=4, grid=VISCOSITIES).json()
    rng = np.random.default_rng(0)
    lengths = [5, 3, 4, 0]
    told = {}
    for run, length in zip(sweep["cases"][1]["runs"], lengths, strict=True):
        told[run] = rng.random((length, 3))
        record(services, run, told[run])
    found = api.get(f"sweeps/{sweep['id']}/summary").json()
    empty, case = found["cases"]
    assert (empty["generation"], empty["qd_score"]["median"]) == ([], [])
    assert case["values"] == {"world.viscosity": 0.1}
    assert case["generation"] == [1, 2, 3, 4, 5]
    assert case["runs"] == [3, 3, 3, 2, 1]
    for at, name in enumerate(("qd_score", "coverage", "best")):
        for generation in case["generation"]:
            known = [
                rows[generation - 1, at] for rows in told.values() if len(rows) >= generation
            ]
            for word, share in (
                ("low", 25),
                ("median", 50),
                ("high", 75),
                ("min", 0),
                ("max", 100),
            ):
                value = case[name][word][generation - 1]
                assert value == pytest.approx(np.percentile(known, share))
    assert [member["seed"] for member in case["members"]] == [0, 1, 2, 3]
    assert [member["generation"] for member in case["members"]] == lengths
    final = case["finals"]["qd_score"]
    last = [told[run][-1, 0] for run in told if len(told[run])]
    assert final["values"] == [*last, None]
    assert final["median"] == pytest.approx(np.median(last))
    thin = api.get(f"sweeps/{sweep['id']}/summary", params={"points": 3}).json()["cases"][1]
    assert (thin["generation"], thin["runs"]) == ([1, 3, 5], [3, 3, 1])
    assert thin["best"]["max"] == [case["best"]["max"][i] for i in (0, 2, 4)]
    lines = api.get(f"sweeps/{sweep['id']}/curves").json()
    assert lines["generation"] == [1, 2, 3, 4, 5]
    (line,) = [one for one in lines["runs"] if one["run"] == sweep["cases"][1]["runs"][1]]
    assert line["coverage"] == [*told[line["run"]][:, 1], None, None]


def test_a_run_that_comes_back_while_a_summary_is_made_is_not_taken_for_another(
    api, services, post
):
    sweep = post(seeds=3).json()
    runs = sweep["cases"][0]["runs"]
    for run, value in zip(runs, (1.0, 2.0, 3.0), strict=True):
        record(services, run, np.full((2, 3), value))
        api.post(f"runs/{run}/cancel")
    api.delete(f"runs/{runs[2]}")
    asked = []

    def restore(*_):
        asked.append(1)
        if len(asked) == 2:
            with services.sessions.write.begin() as session:
                session.get_one(Run, UUID(runs[2])).deleted_at = None

    with services.sessions.read() as session:
        found = session.get_one(Sweep, UUID(sweep["id"]))
        event.listen(session.connection(), "before_cursor_execute", restore)
        (case,) = summary(session, found, None).cases
    assert [str(member.run) for member in case.members] == runs[:2]
    assert (case.best.min, case.best.max) == ([1.0, 1.0], [2.0, 2.0])


def test_a_summary_of_very_long_runs_can_be_asked_for(api, services, post):
    sweep = post(seeds=3).json()
    with services.sessions.write.begin() as session:
        session.execute(update(Run).values(generation=900_000))
    found = api.get(f"sweeps/{sweep['id']}/curves")
    assert (found.status_code, len(found.json()["generation"])) == (200, 10_000)


def record(services, run, rows):
    """Write down generations of a run, as a worker would have."""
    columns = ("qd_score", "coverage", "best")
    others = {"evaluations": 1, "diverged": 0, "seconds": 1.0, "summary": None, "mean": None}
    with services.sessions.write.begin() as session:
        row = session.get_one(Run, UUID(run))
        row.generation = len(rows)
        for generation, values in enumerate(rows.tolist(), 1):
            known = dict(zip(columns, values, strict=True))
            at = {"run_id": row.id, "generation": generation}
            session.execute(insert(Generation), [{**at, **known, **others}])
            row.qd_score, row.coverage, row.best = values


def test_a_summary_asks_the_database_as_often_for_many_runs_as_for_few(services, post):
    sizes = []
    for seeds in (1, 20):
        sweep_id = UUID(post(seeds=seeds, grid=VISCOSITIES).json()["id"])
        asked = []

        def note(_connection, _cursor, statement, *_, asked=asked):
            asked.append(statement)

        with services.sessions.read() as session:
            sweep = session.get_one(Sweep, sweep_id)
            event.listen(services.sessions.engine, "before_cursor_execute", note)
            summary(session, sweep, None)
            event.remove(services.sessions.engine, "before_cursor_execute", note)
        sizes.append(len(asked))
    assert sizes == [2, 2]


def test_of_a_table_the_finals_are_the_figures_of_its_summary(api, services, sweep, table):
    found = api.post("sweeps", json={"spec": sweep, "grid": {"period": [40, 50]}}).json()
    assert (found["seeds"], found["total"]) == ([], 2)
    attempt = claimed(services, found["cases"][0]["runs"][0])
    attempt.record(table(1, {"number": 1}, summary={"points": 4, "note": "words"}), 1.0)
    name = api.get(f"runs/{found['cases'][0]['runs'][0]}").json()["name"]
    assert name == "period=40"
    told = api.get(f"sweeps/{found['id']}/summary").json()["cases"]
    assert told[0]["finals"]["points"]["values"] == [4.0]
    assert set(told[0]["finals"]) == {"evaluations", "points"}
    assert told[0]["qd_score"]["median"] == [None]
    assert "points" not in told[1]["finals"]
    refused = api.post("sweeps", json={"spec": sweep, "seeds": 2}).json()
    assert "`gaits` has no seed" in refused["detail"]


def test_a_sweep_ends_with_the_last_of_its_runs(api, services, six):
    forget_empty_sweeps(services)
    assert api.get(f"sweeps/{six['id']}").status_code == 200
    with services.sessions.write.begin() as session:
        session.execute(delete(Run).where(Run.sweep == UUID(six["id"])))
    forget_empty_sweeps(services)
    assert api.get(f"sweeps/{six['id']}").status_code == 404


def test_the_name_of_a_run_keeps_its_seed_however_long_the_rest_is(api, post):
    found = post(name="n" * 200, grid=VISCOSITIES).json()
    name = api.get(f"runs/{found['cases'][0]['runs'][0]}").json()["name"]
    assert (len(name), name[-10:]) == (200, "… · seed 0")
