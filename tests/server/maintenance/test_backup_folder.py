"""A folder of backups: what it keeps, what it takes for its own, and what it refuses."""

import errno
import json
import os
import shutil
import sqlite3
from pathlib import Path

import pytest
from sqlalchemy import inspect

from microcosmos_server.maintenance import backup
from microcosmos_server.maintenance.__main__ import main
from microcosmos_server.maintenance.backup import (
    COMPLETE,
    MANIFEST,
    BackupError,
    DumpError,
)
from microcosmos_server.storage import mark
from microcosmos_server.storage.artifacts import Artifacts
from microcosmos_server.storage.garbage import remove_files
from microcosmos_server.tables import migrations


@pytest.fixture
def store(services) -> Path:
    return Path(services.settings.artifacts)


@pytest.fixture
def another(elsewhere):
    """Another installation, which has no run."""
    there = elsewhere()
    migrations.upgrade(there.sessions)
    mark.leave(there.sessions, there.artifacts)
    return there


def dumps(folder: Path) -> list[str]:
    return sorted(file.name for file in folder.glob("database-*"))


def test_a_later_backup_copies_what_is_new(services, running, attempt, record, tmp_path):
    backup.make(services, tmp_path)
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "artifacts").rglob("*.h5")}
    record(7)
    attempt.save(7, b"state 7")
    made = backup.make(services, tmp_path)
    after = {path: path.stat().st_mtime_ns for path in (tmp_path / "artifacts").rglob("*.h5")}
    assert len(after) == len(before) + 1
    assert before.items() <= after.items()
    assert dumps(tmp_path) == [made.dump]
    assert backup.read(tmp_path) == made


def test_a_backup_is_on_the_disk_before_the_earlier_one_is_deleted(
    services, running, tmp_path, monkeypatch
):
    """Else a power cut could leave neither."""
    earlier, done = backup.make(services, tmp_path), []
    sync, unlink = os.fsync, Path.unlink

    def note_sync(opened):
        done.append(Path(f"/proc/self/fd/{opened}").resolve().name)
        sync(opened)

    def note_unlink(path, **options):
        done.append(f"deleted {path.name}")
        unlink(path, **options)

    monkeypatch.setattr(os, "fsync", note_sync)
    monkeypatch.setattr(Path, "unlink", note_unlink)
    made = backup.make(services, tmp_path)
    expected = [made.dump, f"{MANIFEST}.part", tmp_path.name, f"deleted {earlier.dump}"]
    assert [one for one in done if one in expected] == expected


@pytest.mark.parametrize("unreadable", [False, True])
def test_a_file_that_the_store_lost_is_named(services, running, tmp_path, store, unreadable):
    path = next(store.rglob("00000004*.h5"))
    path.write_bytes(b"rot")
    if unreadable:  # As where the disk has a bad sector.
        path.unlink()
        path.symlink_to(path.name)
    made = backup.make(services, tmp_path)
    assert len(made.files) == 3
    assert made.faults == backup.check(services)[1]
    (fault,) = made.faults
    what = "cannot be read: OSError: Too many" if unreadable else "is missing or has changed"
    assert fault.startswith(f"runs/{path.parent.name}/{path.name} {what}")


def test_a_backup_that_lacks_files_leaves_the_last_that_lacks_none(
    services, running, attempt, record, tmp_path, store
):
    folder, whole = tmp_path / "backup", backup.make(services, tmp_path / "backup")
    for generation in (7, 8):
        record(generation)
        attempt.save(generation, b"state %d" % generation)
        next(store.rglob(f"{generation:08d}*.h5")).unlink()
        made = backup.make(services, folder)
        assert len(made.faults) == generation - 6
        assert backup.read(folder) == made
        assert dumps(folder) == [whole.dump, made.dump]
    shutil.copytree(folder, tmp_path / "copy")
    (tmp_path / "copy" / COMPLETE).replace(tmp_path / "copy" / MANIFEST)
    assert backup.read(tmp_path / "copy") == whole
    for generation in (9, 10, 11, 12):
        record(generation)
        attempt.save(generation, b"state %d" % generation)
    made = backup.make(services, folder)
    assert made.faults == [], "runs no longer need what was lost"
    assert dumps(folder) == [made.dump]
    assert not (folder / COMPLETE).exists()


def test_a_lost_store_is_neither_backed_up_nor_checked(
    services, running, tmp_path, store, monkeypatch
):
    made = backup.make(services, tmp_path)
    lost = store.rename(store.with_name("lost"))
    for act in (lambda: backup.make(services, tmp_path), lambda: backup.check(services)):
        with pytest.raises(BackupError, match="The store has no file `installation`"):
            act()
    lost.rename(store)
    save_database = backup.save_database

    def lose(*arguments):
        store.rename(lost)
        return save_database(*arguments)

    shutil.rmtree(tmp_path / "artifacts" / "runs")  # So it needs files of the store again.
    monkeypatch.setattr(backup, "save_database", lose)
    with pytest.raises(BackupError, match="The store has no file `installation`"):
        backup.make(services, tmp_path)
    lost.rename(store)
    assert dumps(tmp_path) == [made.dump]


def test_a_backup_that_fails_leaves_no_dump(services, running, tmp_path, monkeypatch):
    made = backup.make(services, tmp_path)

    def interrupt(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(backup, "_copy", interrupt)
        with pytest.raises(KeyboardInterrupt):
            backup.make(services, tmp_path)
    assert dumps(tmp_path) == [made.dump]
    assert backup.read(tmp_path) == made


def test_files_of_others_are_neither_deleted_nor_changed(
    services, running, another, tmp_path, monkeypatch
):
    monkeypatch.setenv("MICROCOSMOS_DATA", str(services.settings.data))
    monkeypatch.setenv("MICROCOSMOS_DATABASE_URL", services.settings.database_url)
    folder = tmp_path / "backup"
    folder.mkdir()
    (folder / "database-of-my-lab.dump").write_text("precious")
    with pytest.raises(SystemExit, match=r"must be new or empty, .*backup, which has other"):
        main(["backup", str(folder)])
    (folder / "database-of-my-lab.dump").unlink()
    main(["backup", str(folder)])
    (folder / "database-of-my-lab.dump").write_text("precious")
    (folder / "run.sh").write_text("#!/bin/sh")
    (folder / "run.sh").chmod(0o755)
    main(["backup", str(folder)])
    assert len(dumps(folder)) == 2
    assert (folder / "run.sh").stat().st_mode & 0o777 == 0o755
    with pytest.raises(BackupError, match="which has other files"):
        backup.make(another, folder)
    assert len(dumps(folder)) == 2


def test_a_folder_without_files_is_empty(services, running, tmp_path, monkeypatch):
    (tmp_path / "lost+found").mkdir()  # The root of a new disk.

    def fail(artifacts, target, data):
        Path(target).parent.mkdir()
        raise OSError(errno.ENOSPC, "No space left on device", target)

    with monkeypatch.context() as full:
        full.setattr(Artifacts, "_write_to_disk", fail)
        with pytest.raises(OSError, match="No space left"):
            backup.make(services, tmp_path)
    assert (tmp_path / "artifacts").is_dir()
    made = backup.make(services, tmp_path)
    assert backup.read(tmp_path) == made


def test_artifacts_without_the_mark_are_files_of_others(services, running, tmp_path):
    (tmp_path / "artifacts" / "runs").mkdir(parents=True)
    (tmp_path / "artifacts" / "runs" / "1.h5").write_text("precious")
    with pytest.raises(BackupError, match="which has other files"):
        backup.make(services, tmp_path)


def test_a_second_backup_into_the_same_folder_is_refused(
    services, running, tmp_path, monkeypatch
):
    save_database = backup.save_database

    def make_another_and_save(*arguments):
        with pytest.raises(BackupError, match=f"Another backup is being made in {tmp_path}"):
            backup.make(services, tmp_path)
        return save_database(*arguments)

    monkeypatch.setattr(backup, "save_database", make_another_and_save)
    made = backup.make(services, tmp_path)
    assert dumps(tmp_path) == [made.dump]
    assert sorted(one.name for one in tmp_path.glob("manifest*")) == [MANIFEST]


def test_a_backup_is_outside_the_store(services, running, store, elsewhere, tmp_path):
    for folder in (services.settings.data, store, store / "backup"):
        with pytest.raises(BackupError, match="must be outside the store"):
            backup.make(services, folder)
    backup.make(services, tmp_path / "backup")
    there = elsewhere(artifacts_url=str(tmp_path / "backup" / "artifacts"))
    with pytest.raises(BackupError, match="must be outside the store"):
        backup.restore(there, tmp_path / "backup")


def test_a_check_names_no_file_that_the_server_deletes_meanwhile(
    services, running, attempt, record, monkeypatch
):
    remove_files(services.sessions, services.artifacts)
    read = backup._read

    def go_on_and_read(*arguments):
        monkeypatch.setattr(backup, "_read", read)
        for generation in (7, 8):
            record(generation)
            attempt.save(generation, b"state %d" % generation)
        assert remove_files(services.sessions, services.artifacts)
        return read(*arguments)

    monkeypatch.setattr(backup, "_read", go_on_and_read)
    assert backup.check(services) == (4, [])


def test_a_damaged_backup_restores_nothing(services, running, elsewhere, tmp_path):
    made = backup.make(services, tmp_path / "backup")
    there = elsewhere()
    hurt = tmp_path / "backup" / "artifacts" / made.files[-1].path
    whole = hurt.read_bytes()
    hurt.write_bytes(b"rot")
    with pytest.raises(BackupError, match=f"nothing was restored:\n{made.files[-1].path}"):
        backup.restore(there, tmp_path / "backup")
    assert not Path(there.artifacts.root).exists()
    hurt.write_bytes(whole)
    (tmp_path / "backup" / made.dump).write_bytes(b"rot")
    with pytest.raises(BackupError, match="has changed"):
        backup.restore(there, tmp_path / "backup")
    assert there.artifacts.find(mark.MARK) is None
    with pytest.raises(BackupError, match=MANIFEST):
        backup.restore(there, tmp_path)


def test_nothing_is_restored_over_something(services, running, elsewhere, tmp_path):
    made = backup.make(services, tmp_path / "backup")
    with pytest.raises(BackupError, match="must be empty"):
        backup.restore(services, tmp_path / "backup")
    there = elsewhere()
    there.artifacts.write(mark.MARK, b"another")
    with pytest.raises(BackupError, match="of another"):
        backup.restore(there, tmp_path / "backup")
    there.artifacts.write(mark.MARK, f"{made.installation}\n".encode())  # By a person.
    assert backup.restore(there, tmp_path / "backup") == made


def test_a_backup_of_a_later_version_is_refused_before_anything_is_written(
    services, running, elsewhere, tmp_path
):
    backup.make(services, tmp_path / "backup")
    manifest = tmp_path / "backup" / MANIFEST
    later = {"revision": "9999", "compression": "zstd"}
    manifest.write_text(json.dumps(json.loads(manifest.read_text()) | later))
    there = elsewhere()
    with pytest.raises(BackupError, match="has tables of revision 9999, which version"):
        backup.restore(there, tmp_path / "backup")
    assert not inspect(there.sessions.engine).get_table_names()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b'{"version": "0.1', "Invalid JSON"),
        (b"\xff\xfe", "Invalid JSON"),
        (b"[]", "Input should be an object"),
        (b'{"files": [{"path": 5}]}', "`version`: Field required"),
    ],
)
def test_a_damaged_manifest_is_named_and_replaced(services, running, tmp_path, content, said):
    backup.make(services, tmp_path)
    (tmp_path / MANIFEST).write_bytes(content)
    with pytest.raises(BackupError, match=rf"{MANIFEST} must be the manifest .*{said}"):
        backup.read(tmp_path)
    made = backup.make(services, tmp_path)
    assert backup.read(tmp_path) == made


def test_a_dump_that_sqlite_cannot_write_is_an_error_with_both_files(
    services, running, tmp_path, monkeypatch
):
    connect_file = sqlite3.connect

    def full(file):
        opened = connect_file(file)
        if str(file).startswith(str(tmp_path)):
            opened.execute("PRAGMA max_page_count = 1")
        return opened

    monkeypatch.setattr(backup.sqlite3, "connect", full)
    with pytest.raises(DumpError, match=rf"SQLite cannot copy .* to {tmp_path}.*: "):
        backup.make(services, tmp_path)
    assert dumps(tmp_path) == []


@pytest.mark.parametrize("words", [["check"], ["backup", "copy"]])
def test_a_mistyped_data_folder_is_not_made(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MICROCOSMOS_DATA", str(tmp_path / "typo"))
    with pytest.raises(SystemExit, match="must be the folder of an installation; there is no"):
        main(words)
    assert list(tmp_path.iterdir()) == []
