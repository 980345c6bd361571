"""Submitting a sweep: its grid and seeds, and invalid sweeps, refused as a whole."""

import json
from concurrent.futures import ThreadPoolExecutor

import pytest
from answers import detail, fields
from pydantic import BaseModel
from sqlalchemy import select

from microcosmos.archive import creature
from microcosmos_server.creatures import initial
from microcosmos_server.sweeps import plan
from microcosmos_server.tables import InitialCreature, Run, Sweep

VISCOSITIES = {"world.viscosity": [0.05, 0.1]}


def test_a_sweep_runs_each_case_with_each_seed_in_order(api, waiting, six):
    assert (six["total"], six["status_counts"], six["progress"]) == (6, {"queued": 6}, 0)
    assert [case["values"] for case in six["cases"]] == [
        {"world.viscosity": 0.05},
        {"world.viscosity": 0.1},
    ]
    found = api.get("runs", params={"sweep": six["id"], "sort": "created"}).json()["items"]
    inputs = [(run["spec"]["world"]["viscosity"], run["spec"]["seed"]) for run in found]
    assert inputs == [(nu, seed) for seed in (0, 1, 2) for nu in (0.05, 0.1)]
    assert found[3]["name"] == "thick and thin · world.viscosity=0.1 · seed 1"
    assert {run["sweep"] for run in found} == {six["id"]}
    ids = [run["id"] for run in found]
    assert [case["runs"] for case in six["cases"]] == [ids[::2], ids[1::2]]
    assert waiting() == ids
    assert api.get(f"sweeps/{six['id']}").json() == six


def test_a_number_of_seeds_goes_on_from_the_specs_own(api, post, spec):
    spec["seed"] = 7
    assert post(seeds=3).json()["seeds"] == [7, 8, 9]
    assert post(seeds=[4, 2]).json()["seeds"] == [4, 2]
    assert post().json()["total"] == 1


def test_a_path_reaches_into_lists_whole_parts_and_parts_that_are_off(api, post):
    def specs(grid):
        cases = post(grid=grid).json()["cases"]
        return [api.get(f"runs/{case['runs'][0]}").json()["spec"] for case in cases]

    ring = {"builder": "ring", "nodes": 8}
    found = specs({"archive.descriptors.0.bins": [4, 8], "body": [ring]})
    assert [one["archive"]["descriptors"][0]["bins"] for one in found] == [4, 8]
    assert {one["archive"]["descriptors"][1]["bins"] for one in found} == {16}
    assert {one["body"]["builder"] for one in found} == {"ring"}
    found = specs({"world.energy.packets": [2, 3]})
    assert [one["world"]["energy"]["packets"] for one in found] == [2, 3]


def test_the_specs_of_a_sweep_are_limited_in_all(api, spec, monkeypatch):
    """Each run has its own copy, with up to 4,096 names of initial creatures."""
    long = len(json.dumps(spec))
    monkeypatch.setattr(plan, "MAX_SPEC_BYTES", 10 * long + 100)
    assert api.post("sweeps/estimate", json={"spec": spec, "seeds": 9}).is_success
    for asked in ({"seeds": 11}, {"seeds": 6, "grid": {"world.viscosity": [0.1, 0.2]}}):
        answer = api.post("sweeps/estimate", json={"spec": spec, **asked})
        assert fields(answer) == ["grid" if "grid" in asked else "seeds"]
        assert "needs specs of at most" in detail(answer, 422)


def test_the_initial_creatures_of_a_sweep_are_limited_in_all(
    api, post, spec, elite, monkeypatch
):
    """One transaction inserts a row for each."""
    monkeypatch.setattr(plan, "MAX_INITIAL", 5)
    spec["search"]["initial"] = [elite]
    for asked in ({"seeds": 6}, {"seeds": 3, "grid": VISCOSITIES}):
        answer = post(**asked)
        assert fields(answer) == ["grid" if "grid" in asked else "seeds"]
        assert "needs at most 5 initial creatures in all runs; got 6 in 6" in detail(
            answer, 422
        )
    assert post(seeds=3, grid={"search.initial": [[], [elite]]}).json()["total"] == 6
    assert post(seeds=5).json()["total"] == 5


def test_initial_creatures_are_inserted_in_parts(services, post, spec, elite, monkeypatch):
    """Of a thousand runs with thousands of names each, at once they fill the memory."""
    inserted, insert = [], initial.insert_missing

    def count(session, table, rows):
        inserted.append(len(rows))
        insert(session, table, rows)

    monkeypatch.setattr(initial, "ROWS", 4)
    monkeypatch.setattr(initial, "insert_missing", count)
    spec["search"]["initial"] = [elite]
    runs = post(seeds=5, grid=VISCOSITIES).json()["cases"]
    assert inserted == [4, 4, 2]
    with services.sessions.read() as session:
        found = session.execute(select(InitialCreature.run_id, InitialCreature.creature)).all()
    assert {(str(run), name) for run, name in found} == {
        (run, elite) for case in runs for run in case["runs"]
    }


def test_the_order_of_settings_makes_no_other_run():
    settings = {"gain": 1, "delay": 2}

    class Plugged(BaseModel):
        settings: dict[str, int]

    one, other = settings, dict(reversed(settings.items()))
    digests = {plan._digest(Plugged(settings=each)) for each in (one, other)}
    assert len(digests) == 1


@pytest.mark.parametrize(
    ("asked", "field", "words"),
    [
        ({"grid": {"world.viscosity": [0.1, 0.2, -1]}}, "grid.world.viscosity[2]", "0.001"),
        ({"grid": {"world.viscosti": [1]}}, "grid.world.viscosti", "`world.viscosity`"),
        ({"grid": {"viscosity": [1]}}, "grid.viscosity", "did you mean `world.viscosity`"),
        ({"grid": {"archive.descriptors.2.bins": [4]}}, "grid.archive.descriptors.2.bins", ""),
        ({"grid": {"seed": [1]}}, "grid.seed", "`seeds`"),
        ({"grid": {"experiment": ["folding"]}}, "grid.experiment", "cannot contain"),
        ({"grid": {"seed.low": [1]}}, "grid.seed.low", "no field"),
        ({"grid": {"world.viscosity": []}}, "grid.world.viscosity", "1 or more items"),
        ({"grid": {"world.viscosity": [1, 1.0]}}, "grid.world.viscosity[1]", "viscosity[0]"),
        ({"grid": {"world": [{}], "world.width": [64]}}, "grid.world.width", "lies in `world`"),
        ({"grid": {"body.nodes": [8, 512]}}, "grid.body.nodes[1]", "with body.nodes=512"),
        (
            {"grid": {"body.nodes": [8, 64], "world.width": [64, 128]}},
            "grid",
            "with body.nodes=64, world.width=64: `world.height` must be at least 74",
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
def test_one_invalid_run_refuses_the_whole_sweep(api, post, asked, field, words):
    answer = post(**asked)
    assert answer.status_code == 422
    problem = answer.json()
    assert field in [error["field"] for error in problem["errors"]]
    assert words in problem["detail"]
    assert api.get("sweeps").json()["items"] == []
    assert api.get("runs").json()["items"] == []


def test_an_error_of_the_spec_is_reported_under_spec(api, spec):
    spec["world"]["viscosity"] = -1
    (error,) = api.post("sweeps", json={"spec": spec}).json()["errors"]
    assert error["field"] == "spec.world.viscosity"
    spec["world"]["viscosity"], spec["seed"] = 0.1, 2**32 - 1
    (error,) = api.post("sweeps", json={"spec": spec, "seeds": 2}).json()["errors"]
    assert (error["field"], "seeds end at 4294967296" in error["reason"]) == ("seeds", True)


def test_memory_is_refused_at_the_value_that_needs_it(api, post, spec):
    spec["archive"]["descriptors"][1]["bins"] = 1024
    grid = {"archive.descriptors.0.bins": [16, 900, 1000], **VISCOSITIES}
    answer = post(grid=grid)
    problem = answer.json()
    assert (answer.status_code, problem["title"]) == (422, "Not enough memory")
    fields = [error["field"] for error in problem["errors"]]
    assert fields == [f"grid.archive.descriptors.0.bins[{place}]" for place in (1, 2)]
    assert "with archive.descriptors.0.bins=900, world.viscosity=0.05" in problem["detail"]
    assert api.get("runs").json()["items"] == []


def test_a_write_that_fails_half_way_leaves_nothing(services, post, monkeypatch):
    def fail(*_):
        raise RuntimeError("half way")

    monkeypatch.setattr(initial, "record", fail)
    assert post(seeds=3).status_code == 500
    with services.sessions.read() as session:
        assert not session.scalars(select(Run.id)).all()
        assert not session.scalars(select(Sweep.id)).all()


@pytest.mark.postgresql
def test_the_same_key_at_once_gives_one_sweep(api, waiting, spec):
    headers, asked = {"Idempotency-Key": "a key"}, {"spec": spec, "seeds": 2}
    with ThreadPoolExecutor(4) as pool:
        sent = [pool.submit(api.post, "sweeps", json=asked, headers=headers) for _ in range(4)]
    answers = [one.result() for one in sent]
    assert sorted(answer.status_code for answer in answers) == [200] * 3 + [202]
    assert len({answer.json()["id"] for answer in answers}) == 1
    assert len(waiting()) == 2
    others = ("sweeps", {**asked, "seeds": 3}), ("sweeps?priority=low", asked), ("runs", spec)
    for path, other in others:
        refused = api.post(path, json=other, headers=headers)
        assert (refused.status_code, refused.json()["title"]) == (422, "Idempotency key reused")
        assert f"sweep {answers[0].json()['id']}" in refused.json()["detail"]


@pytest.fixture
def elite(claimed, run_id, report, identity):
    attempt = claimed(run_id)
    attempt.record(report(1, {0: 1.0}), 1.0)
    attempt.finish()
    return creature.name(identity(1000))


@pytest.mark.parametrize(
    ("asked", "initial", "field"),
    [
        ({}, "ab" * 32, "spec.search.initial"),
        ({"grid": {"search.initial": [[], ["ab" * 32]]}}, None, "grid.search.initial[1]"),
        ({"grid": {"control.timer": ["linear"], **VISCOSITIES}}, None, "spec.control.inputs"),
    ],
)
def test_a_sweep_that_could_not_begin_is_refused(api, post, spec, elite, asked, initial, field):
    spec["search"]["initial"] = [initial or elite]
    answer = post(**asked)
    assert (answer.status_code, answer.json()["errors"][0]["field"]) == (422, field)
    assert len(api.get("runs").json()["items"]) == 1


def test_the_name_of_a_run_keeps_its_seed_however_long_the_rest_is(api, post):
    found = post(name="n" * 200, grid=VISCOSITIES).json()
    name = api.get(f"runs/{found['cases'][0]['runs'][0]}").json()["name"]
    assert (len(name), name[-10:]) == (200, "… · seed 0")
