"""The summary of a sweep: quantiles by generation, and figures at a common generation."""

from types import SimpleNamespace
from uuid import UUID

import numpy as np
import pytest
from sqlalchemy import event

from microcosmos_server.sweeps.summary import common_generation, summary
from microcosmos_server.tables import Generation, Run, Sweep

VISCOSITIES = {"world.viscosity": [0.05, 0.1]}


def test_quantiles_are_those_of_the_runs_that_reached_a_generation(api, services, post):
    sweep = post(seeds=4, grid=VISCOSITIES).json()
    rng = np.random.default_rng(0)
    lengths = [5, 3, 4, 0]
    scores = {}
    for run, length in zip(sweep["cases"][1]["runs"], lengths, strict=True):
        scores[run] = rng.random((length, 3))
        record(services, run, scores[run])
    found = api.get(f"sweeps/{sweep['id']}/summary").json()
    empty, case = found["cases"]
    assert (empty["generation"], empty["qd_score"]["median"]) == ([], [])
    assert case["values"] == {"world.viscosity": 0.1}
    assert case["generation"] == [1, 2, 3, 4, 5]
    assert case["runs"] == [3, 3, 3, 2, 1]
    for at, name in enumerate(("qd_score", "coverage", "best")):
        for generation in case["generation"]:
            long = [rows for rows in scores.values() if len(rows) >= generation]
            known = [rows[generation - 1, at] for rows in long]
            shares = {"low": 25, "median": 50, "high": 75, "min": 0, "max": 100}
            for word, share in shares.items():
                value = case[name][word][generation - 1]
                assert value == pytest.approx(np.percentile(known, share))
    assert [member["seed"] for member in case["members"]] == [0, 1, 2, 3]
    assert [member["generation"] for member in case["members"]] == lengths
    final = case["finals"]["qd_score"]
    assert found["generation"] == 3, "the shortest of the runs that have begun"
    common = [scores[run][2, 0] for run in scores if len(scores[run])]
    assert final["values"] == [*common, None]
    assert final["median"] == pytest.approx(np.median(common))
    thin = api.get(f"sweeps/{sweep['id']}/summary", params={"points": 3}).json()["cases"][1]
    assert (thin["generation"], thin["runs"]) == ([1, 3, 5], [3, 3, 1])
    assert thin["best"]["max"] == [case["best"]["max"][i] for i in (0, 2, 4)]
    lines = api.get(f"sweeps/{sweep['id']}/curves").json()["runs"]
    (line,) = [one for one in lines if one["run"] == sweep["cases"][1]["runs"][1]]
    assert line["coverage"] == [*scores[line["run"]][:, 1], None, None]


def test_each_run_shows_its_best_creature(api, post, claimed, report):
    sweep = post(seeds=2).json()
    first, second = sweep["cases"][0]["runs"]
    made = report(1, {0: 1.0, 1: 3.0, 2: 2.0})
    claimed(first).record(made, 1.0)
    best = api.get(f"runs/{first}/archive").json()["creature"][1]
    (case,) = api.get(f"sweeps/{sweep['id']}/summary").json()["cases"]
    shown = [(member["run"], member["face"]) for member in case["members"]]
    assert shown == [(first, best), (second, None)]
    assert [member["best"] for member in case["members"]] == [made.best, None]


def test_a_run_restored_during_a_summary_is_not_mixed_up(api, services, post):
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


def test_a_summary_of_very_long_runs_can_be_asked_for(api, update_rows, post):
    sweep = post(seeds=3).json()
    update_rows(Run, generation=900_000)
    found = api.get(f"sweeps/{sweep['id']}/curves")
    assert (found.status_code, len(found.json()["generation"])) == (200, 10_000)


def record(services, run, rows):
    """Write down generations of a run, as a worker would have."""
    columns = ("qd_score", "coverage", "best")
    others = {"evaluations": 1, "infeasible": 0, "seconds": 1.0, "summary": None, "mean": None}
    with services.sessions.write.begin() as session:
        row = session.get_one(Run, UUID(run))
        row.generation = len(rows)
        for generation, values in enumerate(rows.tolist(), 1):
            known = dict(zip(columns, values, strict=True))
            session.add(Generation(run_id=row.id, generation=generation, **known, **others))
            row.qd_score, row.coverage, row.best = values


def test_a_summary_takes_as_many_queries_for_many_runs_as_for_few(services, post, statements):
    sizes = []
    for seeds in (1, 20):
        sweep_id = UUID(post(seeds=seeds, grid=VISCOSITIES).json()["id"])
        with services.sessions.read() as session:
            sweep = session.get_one(Sweep, sweep_id)
            sizes.append(statements(summary, session, sweep, None))
    assert sizes == [3, 3]


def test_finals_of_a_table_come_from_its_summary(claimed, api, sweep, table):
    found = api.post("sweeps", json={"spec": sweep, "grid": {"period": [40, 50]}}).json()
    assert (found["seeds"], found["total"]) == ([], 2)
    attempt = claimed(found["cases"][0]["runs"][0])
    attempt.record(table(1, {"number": 1}, summary={"points": 4, "note": "words"}), 1.0)
    cases = api.get(f"sweeps/{found['id']}/summary").json()["cases"]
    assert cases[0]["finals"]["points"]["values"] == [4.0]
    assert set(cases[0]["finals"]) == {"evaluations", "points"}
    assert cases[0]["qd_score"]["median"] == [None]
    assert "points" not in cases[1]["finals"]


@pytest.mark.parametrize(
    ("runs", "common"),
    [
        ([("queued", 0)], None),
        ([("running", 71), ("running", 68), ("queued", 0)], 68),
        ([("running", 71), ("finished", 40), ("cancelled", 3)], 71),
        ([("finished", 400), ("finished", 120), ("failed", 7)], 400),
        ([("failed", 7), ("cancelled", 3)], 3),
    ],
)
def test_runs_are_compared_at_a_common_generation(runs, common):
    rows = [SimpleNamespace(status=status, generation=last) for status, last in runs]
    assert common_generation(rows) == common
