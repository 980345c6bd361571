"""A backup of a running installation, restored elsewhere, has every file that its rows name."""

import json
from contextlib import ExitStack
from pathlib import Path

import pytest
import reports
from databases import own_postgresql
from object_store import new_prefix

from microcosmos.archive import creature
from server.attempts.claim import claim
from server.maintenance import backup, dump
from server.maintenance.__main__ import main
from server.maintenance.backup import MANIFEST, BackupError
from server.maintenance.dump import DumpError
from server.renderings.storage import existing, save
from server.services.services import connect
from server.storage import mark
from server.storage.garbage import remove_files
from server.tables import GIF, Run
from server.workers import registry

pytestmark = pytest.mark.postgresql


@pytest.fixture
def running(services, attempt, record, identity) -> str:
    """A run in progress with checkpoints, whose elite has a film; returns the elite."""
    registry.report(services.sessions, "worker", "a device", 1, "busy")
    for generation in range(1, 6):
        record(generation, {0: float(generation)})
        attempt.save(generation, b"state %d" % generation)
    record(6, {6: 1.0})
    name = creature.name(identity(1000))
    save(services, name, GIF, b"a film")
    return name


@pytest.fixture
def elsewhere(services, tmp_path, database):
    """Makes empty installations on databases of the same kind."""
    with ExitStack() as stack:

        def make(**changes):
            url = f"sqlite:///{tmp_path / 'other' / 'other.sqlite'}"
            if database == "postgresql":
                url = stack.enter_context(own_postgresql())
            changes = {"artifacts_url": str(tmp_path / "other" / "files")} | changes
            changes |= {"data": tmp_path / "other", "database_url": url}
            settings = services.settings.model_copy(update=changes)
            return stack.enter_context(_closing(connect(settings)))

        yield make


class _closing(ExitStack):
    def __init__(self, services):
        super().__init__()
        self.services = services
        self.callback(services.close)

    def __enter__(self):
        return self.services


def test_a_run_in_progress_goes_on_after_the_restore(
    services, running, attempt, record, run_id, elsewhere, tmp_path, row
):
    made, faults = backup.make(services, tmp_path / "backup")
    assert faults == []
    assert [file["path"].partition("/")[0] for file in made.files] == ["replays", *["runs"] * 3]
    record(7, {7: 1.0})  # The original goes on.
    attempt.save(7, b"later")
    there = elsewhere()
    assert backup.restore(there, tmp_path / "backup") == made
    assert backup.check(there) == (4, [])
    assert mark.fault(there.sessions, there.artifacts) is None
    assert existing(there, running, GIF) == b"a film"
    with there.sessions.read() as session:
        found = session.get_one(Run, run_id)
        assert (found.status, found.worker, found.generation) == ("queued", None, 6)
        assert found.attempts_without_checkpoint == 0
        assert registry.live(session, 1e9) == []
    again = claim(there, run_id, "another worker")
    assert (again.restore(), again.generation) == (b"state 5", 5)
    again.record(reports.report(6, {6: 1.0}), 1.0)
    again.end(True, 6, lambda: b"the end")
    assert backup.check(there)[1] == []
    assert (row().status, row().generation) == ("running", 7), "the original does not change"


def test_the_server_deletes_no_file_during_a_backup(
    services, running, tmp_path, monkeypatch, count
):
    copies, seen = dump.save, []

    def save_slowly(*arguments):
        named = copies(*arguments)
        seen.append(remove_files(services.sessions, services.artifacts))
        return named

    monkeypatch.setattr(dump, "save", save_slowly)
    backup.make(services, tmp_path / "backup")
    assert seen == [False]
    assert remove_files(services.sessions, services.artifacts), "it deletes them afterwards"


def test_a_later_backup_copies_what_is_new(services, running, attempt, record, tmp_path):
    backup.make(services, tmp_path)
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "artifacts").rglob("*.h5")}
    record(7)
    attempt.save(7, b"state 7")
    made, _ = backup.make(services, tmp_path)
    after = {path: path.stat().st_mtime_ns for path in (tmp_path / "artifacts").rglob("*.h5")}
    assert len(after) == len(before) + 1
    assert before.items() <= after.items()
    assert [path.name for path in tmp_path.glob("database-*")] == [made.dump]
    assert backup.read(tmp_path) == made


def test_a_file_that_the_store_lost_is_named(services, running, tmp_path, monkeypatch):
    path = next(file for file in _files(services) if file.name.startswith("00000004"))
    path.write_bytes(b"rot")
    made, faults = backup.make(services, tmp_path)
    assert len(made.files) == 3
    assert faults == backup.check(services)[1]
    (fault,) = faults
    assert fault.startswith(f"runs/{path.parent.name}/{path.name} is missing or has changed")


def test_a_damaged_backup_restores_nothing(services, running, elsewhere, tmp_path):
    made, _ = backup.make(services, tmp_path / "backup")
    there = elsewhere()
    hurt = tmp_path / "backup" / "artifacts" / made.files[-1]["path"]
    whole = hurt.read_bytes()
    hurt.write_bytes(b"rot")
    with pytest.raises(BackupError, match=made.files[-1]["path"]):
        backup.restore(there, tmp_path / "backup")
    hurt.write_bytes(whole)
    (tmp_path / "backup" / made.dump).write_bytes(b"rot")
    with pytest.raises(BackupError, match="has changed"):
        backup.restore(there, tmp_path / "backup")
    assert there.artifacts.find(mark.MARK) is None
    with pytest.raises(BackupError, match=MANIFEST):
        backup.restore(there, tmp_path)


def test_nothing_is_restored_over_something(services, running, elsewhere, tmp_path):
    backup.make(services, tmp_path / "backup")
    with pytest.raises(BackupError, match="must be empty"):
        backup.restore(services, tmp_path / "backup")
    there = elsewhere()
    there.artifacts.write(mark.MARK, b"another")
    with pytest.raises(BackupError, match="of another"):
        backup.restore(there, tmp_path / "backup")


def test_a_backup_of_a_folder_is_restored_into_s3(
    services, running, elsewhere, tmp_path, object_store, monkeypatch, capsys, database
):
    monkeypatch.setenv("MICROCOSMOS_DATA", str(services.settings.data))
    monkeypatch.setenv("MICROCOSMOS_DATABASE_URL", services.settings.database)
    main(["backup", str(tmp_path / "backup")])
    there = elsewhere(artifacts_url=new_prefix())
    monkeypatch.setenv("MICROCOSMOS_DATA", str(there.settings.data))
    monkeypatch.setenv("MICROCOSMOS_DATABASE_URL", there.settings.database)
    monkeypatch.setenv("MICROCOSMOS_ARTIFACTS_URL", there.settings.artifacts)
    main(["restore", str(tmp_path / "backup")])
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"4 files and the database ({database}) in ")
    assert said[-1] == "The database names 4 files; 4 are intact."
    there.artifacts.delete(
        json.loads((tmp_path / "backup" / MANIFEST).read_text())["files"][0]["path"]
    )
    with pytest.raises(SystemExit, match="is missing or has changed"):
        main(["check"])


@pytest.mark.parametrize("database", ["postgresql"], indirect=True)
def test_a_missing_program_is_named(services, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(DumpError, match="pg_dump of PostgreSQL must be on PATH"):
        backup.make(services, tmp_path / "backup")


def _files(services) -> list[Path]:
    return sorted(Path(services.settings.artifacts).rglob("*.h5"))
