"""The statistics of runs, or of a sweep, are those of the library, of finished runs alone."""

import csv
from io import StringIO
from uuid import UUID

import numpy as np
import pytest
from answers import detail, errors
from scipy import stats

import microcosmos.statistics
from microcosmos.statistics.effects import holm
from microcosmos_server.statistics import routes
from microcosmos_server.tables import Generation, Run

VISCOSITIES = {"world.viscosity": [0.05, 0.1, 0.2]}
SCORES = np.array([[5.0, 3, 4, 1, 2], [6, 9, 8, 7, 2.5], [12, 11, 10, 14, 13]])


@pytest.fixture
def write(services):
    """A function that writes two generations of a run, and its status."""

    def record(run, score, status="finished", evaluations=8, again=0):
        others = {"infeasible": 0, "seconds": 1.0, "mean": 0.1}
        with services.sessions.write.begin() as session:
            row = session.get_one(Run, UUID(run))
            row.generation, row.status = 2, status
            for number in (1, 2):
                share = number / 2
                corrected = {"corrected_qd_score": 0.8 * score} if number == 2 else None
                session.add(
                    Generation(
                        run_id=row.id,
                        generation=number,
                        evaluations=evaluations * number + again * (number == 2),
                        qd_score=share * score,
                        coverage=share,
                        best=share,
                        summary=corrected,
                        **others,
                    )
                )

    return record


@pytest.fixture
def sweep(post, write):
    found = post(seeds=5, grid=VISCOSITIES).json()
    for case, scores in zip(found["cases"], SCORES, strict=True):
        for run, score in zip(case["runs"], scores.tolist(), strict=True):
            write(run, score)
    return found


@pytest.fixture
def post(api, spec):
    def send(**asked):
        return api.post("sweeps", json={"spec": spec, **asked})

    return send


def read(api, sweep, path="statistics", **query):
    return api.get(path, params={"sweep": sweep["id"], **query})


def test_cases_are_compared_as_in_the_library(api, sweep):
    found = read(api, sweep, measures="qd_score,corrected_qd_score").json()
    names = ["viscosity 0.05", "viscosity 0.1", "viscosity 0.2"]
    assert [group["name"] for group in found["groups"]] == names
    assert [run["run"] for run in found["groups"][1]["runs"]] == sweep["cases"][1]["runs"]
    plain, corrected = found["measures"]
    assert [group["median"] for group in plain["groups"]] == np.median(SCORES, 1).tolist()
    np.testing.assert_allclose(corrected["groups"][0]["values"], 0.8 * SCORES[0])
    assert plain["overall"]["p"] == pytest.approx(stats.kruskal(*SCORES).pvalue)
    p = [
        stats.mannwhitneyu(SCORES[i], SCORES[j], method="exact").pvalue
        for i, j in ((0, 1), (0, 2), (1, 2))
    ]
    assert [pair["p_holm"] for pair in plain["pairs"]] == pytest.approx(holm(p * 2)[:3])
    assert plain["pairs"][1]["a12"] == 0
    assert found["tests"] == 6
    assert found["refusal"] is None


def test_evaluations_of_elites_again_are_not_counted(api, spec, write):
    """All runs made two generations, with other numbers of elites at the end."""
    asked = {"spec": {**spec, "search": spec["search"] | {"reevaluation": {"every": 5}}}}
    made = api.post("sweeps", json={**asked, "seeds": 5, "grid": VISCOSITIES}).json()
    for case, scores in zip(made["cases"], SCORES, strict=True):
        for again, (run, score) in enumerate(zip(case["runs"], scores.tolist(), strict=True)):
            write(run, score, again=again)
    for measures in ("qd_score,corrected_qd_score", "qd_score@16,corrected_qd_score@16"):
        plain, corrected = read(api, made, measures=measures).json()["measures"]
        np.testing.assert_allclose(plain["groups"][0]["values"], SCORES[0])
        np.testing.assert_allclose(corrected["groups"][2]["values"], 0.8 * SCORES[2])


def test_tables_are_downloaded(api, sweep):
    table = read(api, sweep, "statistics.csv")
    assert table.headers["content-type"].startswith("text/csv")
    assert "attachment" in table.headers["content-disposition"]
    rows = list(csv.DictReader(StringIO(table.text)))
    assert sum(row["table"] == "run" for row in rows) == 45
    latex = read(api, sweep, "statistics.tex", measures="best")
    assert latex.text.startswith("% \\usepackage{booktabs}")


def test_any_finished_runs_are_grouped_by_what_differs_in_their_specs(api, sweep):
    of_sweep = read(api, sweep).json()
    thick, _, thin = (case["runs"] for case in sweep["cases"])
    found = api.get("statistics", params={"runs": ",".join([*thin, *thick])}).json()
    assert [group["name"] for group in found["groups"]] == ["viscosity 0.2", "viscosity 0.05"]
    assert [one["run"] for one in found["groups"][0]["runs"]] == thin
    figures = {one["group"]: one for one in of_sweep["measures"][0]["groups"]}
    assert all(figures[one["group"]] == one for one in found["measures"][0]["groups"])
    table = api.get("statistics.csv", params={"runs": ",".join(thick), "measures": "best"})
    assert sum(row["table"] == "run" for row in csv.DictReader(StringIO(table.text))) == 5


def test_runs_that_nobody_has_and_unclear_questions_are_refused(api, sweep):
    nobody, run = str(UUID(int=0)), sweep["cases"][0]["runs"][0]
    missing = api.get("statistics", params={"runs": f"{run},{nobody}"})
    assert (missing.status_code, missing.json()["detail"]) == (
        404,
        f"No run has the id {nobody}.",
    )
    assert api.get("statistics").json()["errors"][0]["field"] == "runs"
    both = api.get("statistics", params={"runs": run, "sweep": sweep["id"]})
    assert both.status_code == 422
    assert api.get("statistics", params={"runs": "those"}).status_code == 422


def test_an_answer_is_made_once_for_each_state_of_the_runs(api, sweep, write, services):
    first = read(api, sweep)
    known = {"If-None-Match": first.headers["etag"]}
    path = f"statistics?sweep={sweep['id']}"
    assert api.get(path, headers=known).status_code == 304
    with services.sessions.write.begin() as session:
        session.get_one(Run, UUID(sweep["cases"][0]["runs"][0])).rewinds += 1
    assert api.get(path, headers=known).status_code == 200


def test_runs_that_are_not_finished_are_refused_with_how_many_are(api, post, write):
    found = post(seeds=2).json()
    write(found["cases"][0]["runs"][0], 1.0)
    refused = read(api, found)
    assert refused.status_code == 409
    assert refused.json()["detail"] == "Statistics need finished runs; 1 of 2 are finished."


def test_failed_runs_are_left_out_and_said(api, sweep, services):
    with services.sessions.write.begin() as session:
        session.get_one(Run, UUID(sweep["cases"][0]["runs"][0])).status = "failed"
    found = read(api, sweep).json()
    assert found["groups"][0]["n"] == 4
    assert found["refusal"].endswith("got 4 in 'viscosity 0.05'.")
    said = "1 run is left out, since it failed or was cancelled."
    assert found["cautions"][0] == said
    latex = read(api, sweep, "statistics.tex").text
    assert f"\n% \\caption{{{said} Groups: " in latex
    rows = list(csv.DictReader(StringIO(read(api, sweep, "statistics.csv").text)))
    left_out = [row["run"] for row in rows if row["table"] == "left out"]
    assert left_out == [sweep["cases"][0]["runs"][0]]
    assert left_out[0] not in [row["run"] for row in rows if row["table"] == "run"]


@pytest.mark.parametrize("measures", ["qd_score", "qd_score@8"])
def test_negative_fitness_is_said_whatever_is_measured(api, sweep, services, measures):
    with services.sessions.write.begin() as session:
        run = UUID(sweep["cases"][0]["runs"][0])
        # Negative in the first generation alone.
        session.get_one(Generation, (run, 1)).best = -0.5
    found = read(api, sweep, measures=measures).json()
    assert any(one.startswith("Some runs have negative fitness") for one in found["cautions"])
    share = 0.5 if "@" in measures else 1.0
    values = found["measures"][0]["groups"][0]["values"]
    np.testing.assert_allclose(values, share * SCORES[0])


def test_no_connection_is_held_while_runs_are_compared(services, sweep, monkeypatch):
    compare, held = microcosmos.statistics.compare, []
    pool = services.sessions.engine.pool

    def watched(*arguments):
        held.append(pool.checkedout())
        return compare(*arguments)

    monkeypatch.setattr(microcosmos.statistics, "compare", watched)
    with services.sessions.read() as session:
        question = routes.of_sweep(session, UUID(sweep["id"]), "")
    assert routes.document(services, question).tests == 9
    assert routes.table(services, question, "csv")
    assert held == [0, 0]


@pytest.mark.parametrize(("limit", "most"), [("MAX_PAIRS", 8), ("MAX_RUN_PAIRS", 224)])
def test_more_pairs_than_an_answer_compares_are_refused(
    api, sweep, services, monkeypatch, limit, most
):
    """Three groups of five runs have 3 pairs of groups and 75 pairs of runs in each measure."""
    monkeypatch.setattr(routes, limit, most + 1)
    assert read(api, sweep).json()["tests"] == 9
    with services.sessions.write.begin() as session:
        for run in sweep["cases"][0]["runs"]:
            session.get_one(Run, UUID(run)).rewinds += 1  # The answer is not kept.
    monkeypatch.setattr(routes, limit, most)
    said = "9 pairs of groups and 225 pairs of runs over all measures"
    for path in ("statistics", "statistics.csv", "statistics.tex"):
        refused = read(api, sweep, path)
        (error,) = errors(refused)
        assert (error["field"], error["got"]) == ("sweep", said)
        assert f"microcosmos compare {sweep['id']}" in detail(refused, 422)
    assert read(api, sweep, measures="qd_score,best").json()["tests"] == 6
    runs = ",".join(run for case in sweep["cases"] for run in case["runs"])
    (error,) = errors(api.get("statistics", params={"runs": runs}))
    assert error["field"] == "runs"
    with services.sessions.write.begin() as session:
        session.get_one(Run, UUID(sweep["cases"][0]["runs"][0])).status = "failed"
    assert read(api, sweep).json()["tests"] == 0  # Four runs have none, whatever they cost.


@pytest.mark.postgresql
def test_more_generations_than_an_answer_reads_are_refused(
    api, post, write, services, update_rows, monkeypatch
):
    """Last values need two of three generations of 10 runs, also where fitness is negative."""
    made = post(seeds=5, grid={"world.viscosity": [0.05, 0.1]}).json()
    runs = [run for case in made["cases"] for run in case["runs"]]
    for score, run in enumerate(runs):
        write(run, 1.0 + score)
    update_rows(Generation, summary=None, best=-1.0)
    with services.sessions.write.begin() as session:
        for run in runs:
            row = session.get_one(Generation, (UUID(run), 2))
            names = [column.name for column in Generation.__table__.columns]
            same = {name: getattr(row, name) for name in names}
            session.add(Generation(**same | {"generation": 3, "evaluations": 24}))
            session.get_one(Run, UUID(run)).generation = 3
    monkeypatch.setattr(routes, "MAX_GENERATIONS", 20)
    last = read(api, made).json()
    assert last["measures"][0]["groups"][1]["values"] == [6.0, 7.0, 8.0, 9.0, 10.0]
    assert any(one.startswith("Some runs have negative fitness") for one in last["cautions"])
    for measure in ("qd_score@16", "coverage>=0.5"):
        refused = read(api, made, measures=measure)
        (error,) = errors(refused)
        assert (error["field"], error["got"]) == ("sweep", "30 in all runs")
        assert "or for last values alone" in detail(refused, 422)
    monkeypatch.setattr(routes, "MAX_GENERATIONS", 30)
    at = read(api, made, measures="qd_score@16").json()
    assert at["measures"][0]["groups"][0]["values"] == [1.0, 2.0, 3.0, 4.0, 5.0]


def test_wrong_use_is_refused_with_a_sentence(api, sweep, write, services):
    unknown = read(api, sweep, measures="beauty!")
    assert (unknown.status_code, unknown.json()["errors"][0]["field"]) == (422, "measures")
    assert read(api, sweep, measures="beauty").status_code == 409
    with services.sessions.write.begin() as session:
        run = UUID(sweep["cases"][0]["runs"][0])
        session.get_one(Generation, (run, 2)).evaluations = 20
    unequal = read(api, sweep)
    assert unequal.status_code == 409
    assert "needs runs with equal evaluations, got 16 in" in unequal.json()["detail"]


def test_a_sweep_without_archives_has_none(api):
    found = api.post("sweeps", json={"spec": {"experiment": "gaits"}, "seeds": 1}).json()
    refused = read(api, found)
    assert refused.status_code == 404
    assert "runs of `gaits` have tables" in refused.json()["detail"]
    assert read(api, {"id": str(UUID(int=0))}).status_code == 404
