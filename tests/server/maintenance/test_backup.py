"""A backup of a running installation, restored elsewhere, has every file that its rows name."""

import time

import pytest
import reports
from object_store import new_prefix

from microcosmos_server.attempts.claim import claim
from microcosmos_server.core.database import clock
from microcosmos_server.maintenance import backup
from microcosmos_server.maintenance.__main__ import main
from microcosmos_server.maintenance.backup import DumpError
from microcosmos_server.renderings.storage import existing
from microcosmos_server.storage import mark
from microcosmos_server.storage.garbage import remove_files
from microcosmos_server.tables import GIF, InstallationState, Run
from microcosmos_server.workers import registry

pytestmark = pytest.mark.postgresql


def test_a_run_in_progress_goes_on_after_the_restore(
    services, running, attempt, record, run_id, elsewhere, tmp_path, row
):
    made = backup.make(services, tmp_path / "backup")
    assert made.faults == []
    assert [file.path.partition("/")[0] for file in made.files] == ["replays", *["runs"] * 3]
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
    services, running, tmp_path, monkeypatch, update_rows
):
    """Neither if the dump takes longer than the server waits, nor if another backup ends."""
    copies, seen = backup.save_database, []

    def save_slowly(*arguments):
        named = copies(*arguments)
        monkeypatch.setattr(backup, "save_database", copies)
        backup.make(services, tmp_path / "another")
        deadline = time.monotonic() + 1.4 * backup.HOLD_SECONDS
        while time.monotonic() < deadline:
            seen.append(remove_files(services.sessions, services.artifacts))
            time.sleep(0.1)
        return named

    monkeypatch.setattr(backup, "save_database", save_slowly)
    monkeypatch.setattr(backup, "HOLD_SECONDS", 1.5)
    monkeypatch.setattr(backup, "RENEW_SECONDS", 0.1)
    backup.make(services, tmp_path / "backup")
    assert set(seen) == {False}
    update_rows(InstallationState, keep_files_until=clock())
    assert remove_files(services.sessions, services.artifacts), "it deletes them afterwards"


def test_a_backup_of_a_folder_is_restored_into_s3(
    services, running, elsewhere, tmp_path, object_store, monkeypatch, capsys, database
):
    monkeypatch.setenv("MICROCOSMOS_DATA", str(services.settings.data))
    monkeypatch.setenv("MICROCOSMOS_DATABASE_URL", services.settings.database_url)
    (tmp_path / "backup").mkdir(mode=0o755)  # It was there before, and others may enter it.
    backup.make(services, tmp_path / "backup")
    main(["backup", str(tmp_path / "backup")])
    files = [one for one in (tmp_path / "backup").rglob("*") if one.is_file()]
    assert {one.stat().st_mode & 0o077 for one in files} == {0}
    there = elsewhere(artifacts_url=new_prefix())
    monkeypatch.setenv("MICROCOSMOS_DATA", str(there.settings.data))
    monkeypatch.setenv("MICROCOSMOS_DATABASE_URL", there.settings.database_url)
    monkeypatch.setenv("MICROCOSMOS_ARTIFACTS_URL", there.settings.artifacts)
    main(["restore", str(tmp_path / "backup")])
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"4 files and the database ({database}) in ")
    assert said[-1] == "The database names 4 files; 4 are intact."
    there.artifacts.delete(backup.read(tmp_path / "backup").files[0].path)
    with pytest.raises(SystemExit, match="is missing or has changed"):
        main(["check"])


@pytest.mark.parametrize("database", ["postgresql"], indirect=True)
def test_a_missing_program_is_named(services, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(DumpError, match="pg_dump of PostgreSQL must be on PATH"):
        backup.make(services, tmp_path / "backup")
