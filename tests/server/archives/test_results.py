"""Results that are tables: written with each generation, read as JSON and CSV."""

import csv
import io
from uuid import UUID

import pytest
from answers import detail
from sqlalchemy.exc import OperationalError

from microcosmos.archive import creature
from microcosmos_server.attempts.claim import claim
from microcosmos_server.tables import Result, Run
from microcosmos_server.workers import registry

WORM = {"swimmer": "worm", "viscosity": 0.5, "ok": True, "number": 1}
RAY = {"swimmer": "ray", "viscosity": 2.0, "ok": False, "number": 2}


@pytest.fixture
def attempt(services, sweep_id):
    """An attempt at the run whose result is a table."""
    return claim(services, sweep_id, "worker")


def test_rows_are_read_in_order_with_their_creatures(api, sweep_id, attempt, table):
    attempt.record(table(1, WORM), 1.0)
    attempt.record(table(2, RAY, {"note": "no creature"}, summary={"best": 3.5}), 1.0)
    found = api.get(f"runs/{sweep_id}/results").json()
    assert (found["generation"], found["summary"]) == (2, {"best": 3.5})
    creatures = [row.pop("creature") for row in found["rows"]]
    assert found["rows"] == [WORM, RAY, {"note": "no creature"}]
    assert creatures[2] is None
    assert all(api.get(f"creatures/{sha}").status_code == 200 for sha in creatures[:2])


def test_a_table_has_a_run_and_curves(api, attempt, sweep, sweep_id, table):
    attempt.record(table(1, WORM, summary={"best": 2.0}), 4.0)
    run = api.get(f"runs/{sweep_id}").json()
    total = len(sweep["swimmers"]) * len(sweep["forms"])
    assert (run["generation"], run["generations"]) == (1, total)
    assert run["progress"] == 1 / total
    assert run["eta_seconds"] == pytest.approx(4.0 * (total - 1))
    assert (run["qd_score"], run["sparkline"], run["summary"]) == (None, [], {"best": 2.0})
    curves = api.get(f"runs/{sweep_id}/generations").json()
    assert (curves["generation"], curves["qd_score"], curves["seconds"]) == ([1], [None], [4.0])
    assert [item["id"] for item in api.get("runs").json()["items"]] == [run["id"]]


def test_the_face_of_a_table_is_the_creature_of_its_newest_row_that_has_one(
    api, attempt, sweep_id, table
):
    attempt.record(table(1, WORM), 1.0)
    attempt.record(table(2, RAY, {"note": "no creature"}), 1.0)
    ray = api.get(f"runs/{sweep_id}/results").json()["rows"][1]["creature"]
    assert api.get(f"runs/{sweep_id}").json()["face"] == ray
    (listed,) = api.get("runs").json()["items"]
    assert listed["face"] == ray


def test_tables_have_no_archive_and_archives_no_table(api, sweep_id, run_id):
    for path in ("archive", "archive.csv"):
        answer = api.get(f"runs/{sweep_id}/{path}")
        assert f"/api/v1/runs/{sweep_id}/results" in detail(answer, 404)
    assert api.get(f"runs/{run_id}/results").json()["rows"] == []
    answer = api.get(f"runs/{run_id}/results.csv")
    assert f"/api/v1/runs/{run_id}/archive" in detail(answer, 404)


def test_a_refinement_has_both_cells_and_a_table(api, services, identity, table):
    file = creature.document(identity(1), None, None)
    run = api.post("runs", json={"experiment": "refinement", "creature": file}).json()["id"]
    claim(services, UUID(run), "worker").record(table(1, {"step": 0, "fitness": 2.5}), 1.0)
    answer = api.get(f"runs/{run}/results.csv")
    assert "refinement-" in answer.headers["content-disposition"]
    assert answer.text.splitlines()[0] == "step,fitness,creature"
    registry.report(services.sessions, "small", "cpu", 1000, "idle")
    large = api.post("runs", json={"experiment": "refinement", "creature": file})
    assert large.json()["errors"][0]["field"] == "segment"


def test_numbers_that_json_lacks_become_null(api, attempt, sweep_id, table):
    rows = ({"displacement": float("nan")}, {"displacement": float("inf")})
    attempt.record(table(1, *rows), 1.0)
    found = api.get(f"runs/{sweep_id}/results").json()["rows"]
    assert [row["displacement"] for row in found] == [None, None]


def test_the_table_as_csv_has_every_column(api, attempt, sweep_id, table):
    assert api.get(f"runs/{sweep_id}/results.csv").status_code == 404
    attempt.record(table(1, WORM), 1.0)
    attempt.record(table(2, {"swimmer": "ray, flat", "late": 1.5}), 1.0)
    answer = api.get(f"runs/{sweep_id}/results.csv")
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    assert "gaits-" in answer.headers["content-disposition"]
    first, second = csv.DictReader(io.StringIO(answer.text))
    assert list(first) == ["swimmer", "viscosity", "ok", "number", "late", "creature"]
    assert (first["viscosity"], first["late"], len(first["creature"])) == ("0.5", "", 64)
    assert (second["swimmer"], second["late"]) == ("ray, flat", "1.5")


def test_a_rewind_drops_rows_and_summary_after_the_checkpoint(
    api, services, attempt, sweep_id, table
):
    attempt.record(table(1, WORM, summary={"best": 1.0}), 1.0)
    attempt.save(1, b"after 1")
    attempt.record(table(2, RAY, RAY, summary={"best": 2.0}), 1.0)
    again = claim(services, sweep_id, "worker")
    found = api.get(f"runs/{sweep_id}/results").json()
    assert (len(found["rows"]), found["summary"]) == (1, {"best": 1.0})
    assert api.get(f"runs/{sweep_id}").json()["summary"] == {"best": 1.0}
    again.record(table(2, RAY), 1.0)
    swimmers = [row["swimmer"] for row in api.get(f"runs/{sweep_id}/results").json()["rows"]]
    assert swimmers == ["worm", "ray"]
    assert api.get(f"runs/{sweep_id}").json()["summary"] == {"best": 1.0}


def test_rows_are_written_once_and_deleted_with_their_run(
    services, sweep_id, attempt, table, count
):
    for _ in range(2):  # The answer to the first commit was lost.
        attempt.record(table(1, WORM, RAY), 1.0)
    assert count(Result) == 2
    with services.sessions.write.begin() as session:
        session.delete(session.get_one(Run, sweep_id))
    assert count(Result) == 0


def test_rows_and_run_are_written_in_one_transaction(
    services, sweep_id, attempt, table, monkeypatch, count
):
    def broken(*_):
        raise OperationalError("insert", {}, Exception("gone"))

    monkeypatch.setattr("microcosmos_server.attempts.attempt.count_results", broken)
    with pytest.raises(OperationalError):
        attempt.record(table(1, WORM), 1.0)
    with services.sessions.read() as session:
        assert session.get_one(Run, sweep_id).generation == 0
    assert count(Result) == 0


def test_new_rows_are_published(sweep_id, attempt, table, published):
    attempt.record(table(1, WORM, summary={"best": 1.0}), 1.0)
    (event,) = [data for kind, data in published() if kind == "results"]
    assert len(event["rows"][0].pop("creature")) == 64
    written = {"generation": 1, "summary": {"best": 1.0}, "rows": [WORM]}
    assert event == {"run": str(sweep_id), **written}
