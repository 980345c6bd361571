"""Backups of a running installation, and restoring one into an empty installation.

The database names the files, and no file changes once it is written. So the database is copied
first, then the files that the copy names. The server deletes no file meanwhile.
"""

import hashlib
import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from sqlalchemy import delete, inspect, select, update

from microcosmos.version import VERSION

from ..core.database import now
from ..core.errors import StoreUnavailable
from ..runs.lifecycle import release, stop_attempt
from ..services.services import Services
from ..settings import create_private
from ..storage.artifacts import Artifacts, StoredFile
from ..storage.mark import MARK
from ..tables import QUEUED, RUNNING, InstallationState, Run, Worker, migrations
from . import dump

MANIFEST, FILES = "manifest.json", "artifacts"
HOLD_SECONDS, RENEW_SECONDS = 600.0, 60.0
"""Seconds for which the server deletes no file, and after which a backup asks for more."""


class BackupError(RuntimeError):
    """A backup cannot be made or restored; the message says why."""


@dataclass(frozen=True)
class Backup:
    """A backup as its manifest describes it."""

    version: str
    made_at: str
    installation: str
    database: str
    dump: str
    dump_sha256: str
    files: list[dict[str, Any]]


def make(services: Services, folder: Path) -> tuple[Backup, list[str]]:
    """Back up into a folder; return the backup, and the files that the store has not intact.

    A folder with an earlier backup keeps it until the new one is complete.
    """
    create_private(folder)
    copies, engine = Artifacts(str(folder / FILES)), services.sessions.engine
    with _no_deletion(services) as renew:
        name = f"database-{datetime.now(UTC):%Y%m%dT%H%M%S%f}.{engine.dialect.name}"
        named = dump.save(engine, folder / name)
        copied, faults = [], []
        for file in named:
            renew()
            fault = _copy(file, services.artifacts, copies)
            faults.append(fault) if fault else copied.append(asdict(file))
        with services.sessions.read() as session:
            own = str(session.scalars(select(InstallationState.id)).one())
        made_at = datetime.now(UTC).isoformat(timespec="seconds")
        digest = _digest(folder / name)
        made = Backup(VERSION, made_at, own, engine.dialect.name, name, digest, copied)
    part = folder / f"{MANIFEST}.part"
    part.write_text(json.dumps(asdict(made), indent=1))
    part.replace(folder / MANIFEST)
    for older in folder.glob("database-*"):
        if older.name != name:
            older.unlink()
    return made, faults


def restore(services: Services, folder: Path) -> Backup:
    """Restore a backup into an empty installation, and check each file that it names."""
    made, copies = read(folder), Artifacts(str(folder / FILES))
    engine = services.sessions.engine
    if made.database != engine.dialect.name:
        raise BackupError(
            f"MICROCOSMOS_DATABASE_URL must name a database of {made.database}, as in the "
            f"backup; got one of {engine.dialect.name}"
        )
    if inspect(engine).get_table_names():
        raise BackupError(f"The database {engine.url!r} must be empty; it has tables.")
    if services.artifacts.find(MARK) not in (None, made.installation.encode()):
        raise BackupError(f"The store {services.artifacts.location} has files of another one.")
    for one in made.files:
        if fault := _copy(StoredFile(**one), copies, services.artifacts):
            raise BackupError(f"The backup is damaged: {fault}. Nothing was restored.")
    engine.dispose()
    dump.load(engine, folder / made.dump)
    migrations.upgrade(services.sessions)
    services.artifacts.write(MARK, made.installation.encode())
    _return_runs(services)
    return made


def read(folder: Path) -> Backup:
    """Return the backup in a folder, if its copy of the database is intact."""
    try:
        made = Backup(**json.loads((folder / MANIFEST).read_text()))
        digest = _digest(folder / made.dump)
    except FileNotFoundError as error:
        raise BackupError(
            f"{folder} must contain a backup; it has no {error.filename}"
        ) from None
    if digest != made.dump_sha256:
        raise BackupError(f"The backup is damaged: {made.dump} has changed.")
    return made


def _digest(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()


def check(services: Services) -> tuple[int, list[str]]:
    """Return the number of files that the database names, and what is wrong with some."""
    with services.sessions.read() as session:
        named = [StoredFile(*row) for row in session.execute(dump.NAMED)]
    faults = [fault for file in named if (fault := _fault(file, services.artifacts))]
    return len(named), faults


def _copy(file: StoredFile, source: Artifacts, target: Artifacts) -> str | None:
    """Copy a file unless it is there; return what is wrong with it in the source."""
    if _fault(file, target) is None:
        return None
    data = source.read_verified(file.path, file.sha256)
    if data is None:
        return f"{file.path} is missing or has changed"
    target.write(file.path, data)
    return None


def _fault(file: StoredFile, store: Artifacts) -> str | None:
    try:
        intact = store.read_verified(file.path, file.sha256) is not None
    except StoreUnavailable as error:
        return f"{file.path} cannot be read: {error}"
    return None if intact else f"{file.path} is missing or has changed"


@contextmanager
def _no_deletion(services: Services) -> Iterator[Any]:
    """Have the server delete no file; yield a function to call from time to time."""
    due = 0.0

    def renew() -> None:
        nonlocal due
        if time.monotonic() >= due:
            _hold(services, HOLD_SECONDS)
            due = time.monotonic() + RENEW_SECONDS

    renew()
    try:
        yield renew
    finally:
        _hold(services, 0.0)


def _hold(services: Services, seconds: float) -> None:
    with services.sessions.write.begin() as session:
        until = now(session) + timedelta(seconds=seconds)
        session.execute(update(InstallationState).values(keep_files_until=until))


def _return_runs(services: Services) -> None:
    """Return all runs to the queue that a worker had; that counts as no attempt."""
    with services.sessions.write.begin() as session:
        taken = select(Run.id).where(Run.status.in_((RUNNING, QUEUED)), Run.worker.is_not(None))
        for run_id in session.scalars(taken).all():
            _ = stop_attempt(session, run_id) or release(session, run_id)
        session.execute(delete(Worker))
        session.execute(update(InstallationState).values(keep_files_until=None))
