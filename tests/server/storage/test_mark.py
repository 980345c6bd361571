"""A store carries the id of its installation, and a worker with another store takes no run."""

import shutil
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

import httpx
import pytest
from sqlalchemy import text

from microcosmos_server.maintenance import __main__ as maintenance
from microcosmos_server.schedule.take import take
from microcosmos_server.storage import mark
from microcosmos_server.storage.artifacts import Artifacts
from microcosmos_server.tables import migrations
from microcosmos_server.workers import registry
from microcosmos_worker.device import Device
from microcosmos_worker.readiness import Readiness

pytestmark = pytest.mark.postgresql


@pytest.fixture
def store(services) -> Path:
    return Path(services.settings.artifacts)


def fault(services, artifacts=None):
    return mark.fault(services.sessions, artifacts or services.artifacts)


def test_the_first_start_marks_the_store_and_a_later_one_leaves_it(services, store, serve):
    shutil.rmtree(store, ignore_errors=True)
    assert "has no file `installation`" in fault(services)
    with serve():
        pass
    written = (store / mark.MARK).read_text()
    assert fault(services) is None
    with serve():
        pass
    assert (store / mark.MARK).read_text() == written


def test_an_empty_folder_in_place_of_a_used_store_is_not_marked(
    services, attempt, record, store, serve
):
    record(1)
    attempt.checkpoint(1, b"a checkpoint")
    shutil.rmtree(store)  # As where a mount is missing.
    store.mkdir()
    with serve() as address:
        ready = httpx.get(f"{address}/readyz")
        assert (ready.status_code, ready.json()["store"]) == (503, "wrong or unreachable")
        health = httpx.get(f"{address}/api/v1/health").json()
        assert "has no file `installation`" in health["disk"]["error"]
        assert httpx.get(f"{address}/api/v1/runs").status_code == 200
    assert not (store / mark.MARK).exists()


def test_the_store_of_another_installation_is_named(services, tmp_path):
    other = Artifacts(str(tmp_path))
    known = str(uuid4())
    other.write(mark.MARK, known.encode())
    reason = fault(services, other)
    assert reason.startswith(f"The store belongs to installation {known}")
    assert str(tmp_path) not in reason, "readers of the page need no path of the server"
    mark.leave(services.sessions, other)
    assert (tmp_path / mark.MARK).read_text() == known, "it stays the other's"


def test_a_store_that_cannot_be_read_is_a_fault_and_no_error(services, tmp_path):
    (tmp_path / mark.MARK).mkdir()
    assert "cannot be read: IsADirectoryError" in fault(services, Artifacts(str(tmp_path)))


@pytest.fixture
def readiness(services, monkeypatch) -> Readiness:
    """That of a worker whose device is good."""
    ready = Readiness(services, Device("a device", 8 << 30, {}))
    monkeypatch.setattr(ready, "device_kinds", ["cpu"])
    return ready


def test_a_worker_without_the_store_takes_no_run_until_it_is_there(
    services, run_id, store, readiness, reason
):
    kept = (store / mark.MARK).read_text()
    (store / mark.MARK).unlink()
    for _ in range(2):
        assert not readiness.check()
    report(services, readiness)
    assert take(services, "lost") is None
    assert reason(run_id).startswith("Worker lost: The store has no file")
    (store / mark.MARK).write_text(kept)
    assert readiness.check()
    assert readiness.problem is None
    report(services, readiness)
    assert reason(run_id).startswith("A worker is free")
    assert take(services, "lost") == run_id


def report(services, readiness):
    found = readiness.problem
    kind, text = (found.kind, found.text) if found else (None, None)
    lost = (services.sessions, "lost", "a device", 8 << 30, "idle")
    registry.report(*lost, problem=text, problem_kind=kind)


@pytest.mark.parametrize(
    ("revision", "begin"),
    [
        ("9999", "The tables of the database have revision 9999, which version "),
        ("0000", "The tables of the database have revision 0000, and version "),
    ],
)
def test_a_worker_takes_no_run_from_tables_of_another_version(
    services, run_id, readiness, reason, revision, begin, monkeypatch
):
    (own,) = migrations.known()
    monkeypatch.setattr(migrations, "known", lambda: (own, "0000"))
    with revised(services, revision):
        assert not readiness.check()
        assert readiness.problem.kind == "schema"
        assert readiness.problem.text.startswith(begin)
        report(services, readiness)
        assert reason(run_id).startswith(f"Worker lost: {begin}")
    assert readiness.check()


def test_later_tables_are_neither_upgraded_nor_copied(services, tmp_path, monkeypatch):
    monkeypatch.setattr(maintenance, "connect", lambda _: services)
    monkeypatch.setattr(maintenance, "from_environment", lambda: services.settings)
    with revised(services, "9999"):
        with pytest.raises(migrations.SchemaError, match=r"which version .* does not know"):
            migrations.upgrade(services.sessions)
        for act in ("backup", str(tmp_path / "copy")), ("check",):
            with pytest.raises(SystemExit, match="have revision 9999"):
                maintenance.main([*act])
    assert not (tmp_path / "copy").exists()


@contextmanager
def revised(services, revision):
    """Another revision of the tables for a while, as another version leaves it."""
    set_to = text("UPDATE alembic_version SET version_num = :revision")
    for found in (revision, migrations.newest()):
        with services.sessions.write.begin() as session:
            session.execute(set_to, {"revision": found})
        if found == revision:
            yield


def test_a_good_store_is_not_read_before_every_job(services, readiness, statements):
    mark.leave(services.sessions, services.artifacts)
    assert statements(readiness.check) > 0
    assert statements(readiness.check) == 0
