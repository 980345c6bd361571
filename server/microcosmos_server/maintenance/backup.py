"""Back up a running installation, and restore a backup into an empty installation.

The database names the files, and no file changes once it is written. So the database is copied
first, then the files that the copy names. The server deletes no file meanwhile.
"""

import fcntl
import hashlib
import os
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path

from psycopg.conninfo import make_conninfo
from pydantic import BaseModel, ValidationError
from sqlalchemy import Engine, delete, inspect, select, text, update

from microcosmos.archive.atomic import sync_folder
from microcosmos.version import VERSION

from ..core import processes
from ..core.database import now
from ..core.errors import StoreUnavailable
from ..runs.lifecycle import release, stop_attempt
from ..services.periodic import repeating
from ..services.services import Services
from ..settings import create_private
from ..storage import mark
from ..storage.artifacts import Artifacts, StoredFile
from ..storage.mark import MARK
from ..tables import QUEUED, RUNNING, Artifact, InstallationState, Run, Worker, migrations

NAMED = select(Artifact.path, Artifact.size, Artifact.sha256).order_by(Artifact.path)
"""The files that a database names."""


class DumpError(RuntimeError):
    """The database cannot be copied; the message says why."""


def save_database(engine: Engine, file: Path) -> list[StoredFile]:
    """Copy a database as it is now; return the files that the copy names."""
    if engine.dialect.name == "sqlite":
        return _save_sqlite(engine, file)
    with engine.connect().execution_options(isolation_level="REPEATABLE READ") as connection:
        # The snapshot is shared until the dump has begun, however slowly.
        connection.execute(text("SET LOCAL idle_in_transaction_session_timeout = 0"))
        snapshot = connection.execute(text("SELECT pg_export_snapshot()")).scalar_one()
        named = [StoredFile(*row) for row in connection.execute(NAMED)]
        _run(engine, "pg_dump", f"--snapshot={snapshot}", "--format=custom", f"--file={file}")
    return named


def load_database(engine: Engine, file: Path) -> None:
    """Fill an empty database with a copy."""
    if engine.dialect.name == "sqlite":
        _copy_sqlite(file, Path(str(engine.url.database)))
        return
    _run(engine, "pg_restore", "--exit-on-error", "--single-transaction", str(file))


def _save_sqlite(engine: Engine, file: Path) -> list[StoredFile]:
    _copy_sqlite(Path(str(engine.url.database)), file)
    with closing(sqlite3.connect(file)) as copy:
        copy.execute("PRAGMA journal_mode=DELETE")  # One file, without a log beside it.
        columns = "path, size, lower(hex(sha256))"
        rows = copy.execute(f"SELECT {columns} FROM artifacts ORDER BY path").fetchall()
    return [StoredFile(*row) for row in rows]


def _copy_sqlite(source: Path, target: Path) -> None:
    try:
        with (
            closing(sqlite3.connect(source)) as original,
            closing(sqlite3.connect(target)) as copy,
        ):
            original.backup(copy)
    except sqlite3.Error as error:
        raise DumpError(f"SQLite cannot copy {source} to {target}: {error}") from error


def _run(engine: Engine, program: str, *options: str) -> None:
    """Run a program of PostgreSQL. Every user can read arguments, so they have no password."""
    if shutil.which(program) is None:
        raise DumpError(f"{program} of PostgreSQL must be on PATH; it was not found")
    # The parts of the URL as the driver gets them, whatever characters they have.
    _, parts = engine.dialect.create_connect_args(engine.url)
    password = parts.pop("password", None)
    parts.pop("context", None)  # Of the driver's Python alone.
    command = [program, "--no-owner", "--no-privileges", *options]
    command += [f"--dbname={make_conninfo('', **parts)}"]
    secret = {"PGPASSWORD": str(password)} if password else {}
    done = processes.run(command, os.environ | secret)
    if done.code:
        errors = done.errors.decode(errors="replace").strip()
        raise DumpError(f"{program} failed: {errors[-1000:]}")


MANIFEST, COMPLETE, FILES = "manifest.json", "manifest-complete.json", "artifacts"
"""Files of a folder of backups: the manifest of the last one; while that one lacks files, the
manifest of the last one that lacks none; and the folder of all copies."""
HOLD_SECONDS, RENEW_SECONDS = 300.0, 60.0
"""Seconds for which the server deletes no file, and after which a backup asks for more."""


class BackupError(RuntimeError):
    """A backup cannot be made, restored or checked; the message says why."""


class Backup(BaseModel):
    """A backup as its manifest describes it."""

    # Fields of a later version are ignored: `restore` names that version by its tables.
    version: str
    made_at: str
    installation: str
    database: str
    revision: str
    dump: str
    dump_sha256: str
    files: list[StoredFile]
    faults: list[str]
    """The faults of files that the store had lost, and that the backup lacks."""


def make(services: Services, folder: Path) -> Backup:
    """Back up into a folder that is new or empty, or has backups of this installation.

    An earlier backup stays until the new one is complete, and as long as the new one lacks
    files that the store has lost.
    """
    _refuse_overlap(services.artifacts, folder)
    _refuse_lost_store(services)
    kind = services.sessions.engine.dialect.name
    dump = folder / f"database-{datetime.now(UTC):%Y%m%dT%H%M%S%f}.{kind}"
    part = folder / f"{MANIFEST}.part"
    with _private_files(), _locked(folder), _no_deletion(services):
        copies = _open(services, folder)
        try:
            made = _copy_all(services, dump, copies)
            superseded = _superseded(folder, made)
            part.write_text(made.model_dump_json(indent=1))
            for file in (dump, part):
                _sync(file)
        except BaseException:
            dump.unlink(missing_ok=True)
            raise
        part.replace(folder / MANIFEST)  # At once: until now the earlier backup counts.
        sync_folder(folder)  # A power cut must not leave the one without the other.
    for file in superseded:
        file.unlink(missing_ok=True)
    return made


def _superseded(folder: Path, made: Backup) -> list[Path]:
    """Return files of earlier backups that are of no use beside a new one.

    While the new one lacks files, the last one that lacks none stays, under another name.
    """
    last, complete = _earlier(folder / MANIFEST), _earlier(folder / COMPLETE)
    if not made.faults:
        return [folder / COMPLETE, *(folder / one.dump for one in (last, complete) if one)]
    if last and last.faults:
        return [folder / last.dump]
    if last:
        shutil.copyfile(folder / MANIFEST, folder / COMPLETE)
        _sync(folder / COMPLETE)
    return []


def _sync(path: Path) -> None:
    """Return once a file is on the disk."""
    with path.open("rb") as file:
        os.fsync(file.fileno())


def _open(services: Services, folder: Path) -> Artifacts:
    """Return the store of the copies in a folder, with the mark of this installation."""
    copies, own = Artifacts(str(folder / FILES)), _installation(services)
    if mark.found(copies) != own:
        if not _is_empty(folder):
            raise BackupError(
                f"The folder must be new or empty, or have backups of installation {own}; got "
                f"{folder}, which has other files"
            )
        copies.write(MARK, own.encode())
    return copies


def _is_empty(folder: Path) -> bool:
    """Return whether a folder has no files but those of its disk.

    A first backup that could not write its mark leaves a folder without files.
    """
    beside = {one.name for one in folder.iterdir()} - {FILES, "lost+found"}
    return not beside and all(one.is_dir() for one in (folder / FILES).rglob("*"))


def _copy_all(services: Services, dump: Path, copies: Artifacts) -> Backup:
    copied: list[StoredFile] = []
    faults: list[str] = []
    for file in save_database(services.sessions.engine, dump):
        fault = _copy(file, services.artifacts, copies)
        faults.append(fault) if fault else copied.append(file)
    if faults:
        _refuse_lost_store(services)  # A mount may be lost meanwhile.
    return Backup(
        version=VERSION,
        made_at=datetime.now(UTC).isoformat(timespec="seconds"),
        installation=_installation(services),
        database=services.sessions.engine.dialect.name,
        revision=migrations.revision(services.sessions) or "",
        dump=dump.name,
        dump_sha256=_digest(dump),
        files=copied,
        faults=faults,
    )


def restore(services: Services, folder: Path) -> Backup:
    """Restore a backup into an empty installation, after a check of each file that it names."""
    _refuse_overlap(services.artifacts, folder)
    made, copies = read(folder), Artifacts(str(folder / FILES))
    engine = services.sessions.engine
    if made.database != engine.dialect.name:
        raise BackupError(
            f"MICROCOSMOS_DATABASE_URL must name a database of {made.database}, as in the "
            f"backup; got one of {engine.dialect.name}"
        )
    if made.revision not in migrations.known():
        raise BackupError(
            f"The backup of version {made.version} has tables of revision {made.revision}, "
            f"which version {VERSION} does not know."
        )
    if inspect(engine).get_table_names():
        raise BackupError(f"The database {engine.url!r} must be empty; it has tables.")
    if mark.found(services.artifacts) not in (None, made.installation):
        raise BackupError(f"The store {services.artifacts.location} has files of another one.")
    # All before the first is written.
    if faults := [fault for one in made.files if (fault := _read(one, copies)[1])]:
        lines = "\n".join(faults)
        raise BackupError(f"The backup is damaged; nothing was restored:\n{lines}")
    for one in made.files:
        if fault := _copy(one, copies, services.artifacts):
            raise BackupError(f"The backup has changed meanwhile: {fault}.")
    engine.dispose()
    load_database(engine, folder / made.dump)
    migrations.upgrade(services.sessions)
    services.artifacts.write(MARK, made.installation.encode())
    _return_runs(services)
    return made


def read(folder: Path) -> Backup:
    """Return the backup in a folder, if its copy of the database is intact."""
    try:
        made = _manifest(folder / MANIFEST)
        digest = _digest(folder / made.dump)
    except FileNotFoundError as error:
        raise BackupError(
            f"{folder} must contain a backup; it has no {error.filename}"
        ) from None
    if digest != made.dump_sha256:
        raise BackupError(f"The backup is damaged: {made.dump} has changed.")
    return made


def _manifest(file: Path) -> Backup:
    try:
        return Backup.model_validate_json(file.read_bytes())
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise BackupError(
            f"{file} must be the manifest of a backup: {place and f'`{place}`: '}{first['msg']}"
        ) from None


def _earlier(manifest: Path) -> Backup | None:
    """Return an earlier backup; None without one, or if its manifest is damaged."""
    with suppress(FileNotFoundError, BackupError):
        return _manifest(manifest)
    return None


def _digest(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()


def check(services: Services) -> tuple[int, list[str]]:
    """Return the number of files that the database names, and the faults of some."""
    _refuse_lost_store(services)
    with services.sessions.read() as session:
        named = [StoredFile(*row) for row in session.execute(NAMED)]
    faults: list[str] = []
    for file in named:
        _, fault = _read(file, services.artifacts)
        if fault and _is_named(services, file):
            faults.append(fault)
    return len(named), faults


def _is_named(services: Services, file: StoredFile) -> bool:
    """Return whether the database still names a file, which a server may delete meanwhile."""
    with services.sessions.read() as session:
        return session.get(Artifact, file.path) is not None


def _copy(file: StoredFile, source: Artifacts, target: Artifacts) -> str:
    """Copy a file unless the target has it; return its fault in the source."""
    if not _read(file, target)[1]:
        return ""
    data, fault = _read(file, source)
    if not fault:
        target.write(file.path, data)
    return fault


def _read(file: StoredFile, store: Artifacts) -> tuple[bytes, str]:
    """Return the content of a file, and its fault, which is empty if it is intact."""
    try:
        data = store.read_verified(file.path, file.sha256)
    except StoreUnavailable as error:
        store.find(MARK)  # Raises it again if the whole store is away.
        return b"", f"{file.path} cannot be read: {error}"
    return (b"", f"{file.path} is missing or has changed") if data is None else (data, "")


def _refuse_lost_store(services: Services) -> None:
    # Behind a lost mount every file is missing.
    if fault := mark.fault(services.sessions, services.artifacts):
        raise BackupError(f"{fault}.")


def _refuse_overlap(store: Artifacts, folder: Path) -> None:
    """Refuse a folder of backups whose copies would be files of the store, or among them."""
    copies, files = (folder / FILES).resolve(), Path(store.root).resolve()
    if store.local and (copies.is_relative_to(files) or files.is_relative_to(copies)):
        raise BackupError(f"A backup must be outside the store {files}; got {folder}")


def _installation(services: Services) -> str:
    with services.sessions.read() as session:
        return str(session.scalars(select(InstallationState.id)).one())


@contextmanager
def _private_files() -> Iterator[None]:
    """Make files that no other user can read, also in a folder that others may enter."""
    before = os.umask(0o077)
    try:
        yield
    finally:
        os.umask(before)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Make a folder, and refuse another backup into it until the end of the block."""
    create_private(folder)
    opened = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # Some file systems have no locks.
            try:
                fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise BackupError(f"Another backup is being made in {folder}") from None
        yield
    finally:
        os.close(opened)


@contextmanager
def _no_deletion(services: Services) -> Iterator[None]:
    """Keep the server from deleting files, until some minutes after the end of the block.

    Nothing ends this early: another backup may need it.
    """
    _hold(services)  # Before anything is copied.
    with repeating("backup", RENEW_SECONDS, lambda _: _hold(services)):
        yield


def _hold(services: Services) -> None:
    with services.sessions.write.begin() as session:
        until = now(session) + timedelta(seconds=HOLD_SECONDS)
        session.execute(update(InstallationState).values(keep_files_until=until))


def _return_runs(services: Services) -> None:
    """Queue the runs of all workers again, without counting an attempt."""
    with services.sessions.write.begin() as session:
        taken = select(Run.id).where(Run.status.in_((RUNNING, QUEUED)), Run.worker.is_not(None))
        for run_id in session.scalars(taken).all():
            _ = stop_attempt(session, run_id) or release(session, run_id)
        session.execute(delete(Worker))
        session.execute(update(InstallationState).values(keep_files_until=None))
