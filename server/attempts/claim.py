"""One attempt at a run, and all that is written of it."""

import logging
from dataclasses import dataclass
from hashlib import sha256
from time import monotonic
from typing import Any
from uuid import UUID

from sqlalchemy import case, func
from sqlalchemy.orm import Session

from microcosmos.archive.report import Report

from ..core.database import clock
from ..creatures import initial
from ..runs import log
from ..runs.announce import announce
from ..runs.lifecycle import change, hand_back, release
from ..runs.log import UNSAVED, Level, note
from ..services.services import Services
from ..storage.artifacts import Stored, checkpoint_path
from ..tables import (
    CANCELLED,
    FAILED,
    FINISHED,
    OVERRIDE_NEEDED,
    PAUSED,
    RUNNING,
    Artifact,
    Run,
)
from . import recording
from .checkpoints import checkpoints, fall_back, point_at

logger = logging.getLogger(__name__)

ANNOUNCE_EVERY = 1.0
"""Seconds between two events that tell how a run as a whole stands."""


class CheckpointUnavailable(Exception):
    """The store lacks a sound file of a checkpoint that the run has."""


class ClaimLost(Exception):
    """The run is another attempt's by now, or was ended."""


@dataclass
class Claim:
    """One attempt at a run."""

    services: Services
    run_id: UUID
    attempt: int
    spec: dict[str, Any]
    generation: int
    """The one that the checkpoint holds; 0 without one."""
    seconds: float
    """Wall time of the computing that led to the last record."""
    other_device: bool = False
    """Whether people gave leave to go on on another kind of device than began the run."""
    announced: float = 0.0
    """When everybody was last told how the run as a whole stands."""

    def use(self, device: str) -> None:
        """Say which kind of device computes."""
        self._end(f"Computing on {device}.", device=device)

    def initial(self) -> list[dict[str, Any]]:
        """The files of the creatures that the run begins from."""
        names = self.spec.get("search", {}).get("initial", [])
        with self.services.sessions.read() as session:
            return initial.files(session, names)

    def restore(self) -> bytes | None:
        """Return the content of the newest sound checkpoint; None before the first one.

        Older checkpoints stand in for damaged ones, and what was recorded after them is
        deleted. Raise `CheckpointUnavailable`, and delete nothing, where a file is missing
        or all are damaged: then the store may be the wrong one, and a person has to decide.
        Call it before anything is recorded.
        """
        with self.services.sessions.read() as session:
            rows = checkpoints(session, self.run_id)
        damaged: list[str] = []
        for row in rows:
            try:
                data = self.services.artifacts.read(row.path)
            except FileNotFoundError:
                raise CheckpointUnavailable(self._unavailable(row, "is missing")) from None
            if sha256(data).hexdigest() == row.sha256:
                if damaged:
                    self._fall_back(row, damaged)
                return data
            damaged.append(row.path)
        if rows:
            raise CheckpointUnavailable(
                self._unavailable(rows[0], "and all before it are damaged")
            )
        return None

    def _unavailable(self, row: Artifact, what: str) -> str:
        return (
            f"The checkpoint of generation {row.generation} {what}: no sound file `{row.path}` "
            f"in {self.services.artifacts.root}. Check MICROCOSMOS_ARTIFACTS_URL and the "
            "folder's mount, or restore the file"
        )

    def _fall_back(self, sound: Artifact, damaged: list[str]) -> None:
        text = (
            f"The checkpoint of generation {self.generation} is damaged; "
            f"the run resumes from generation {sound.generation}."
        )
        with self.services.sessions.write.begin() as session:
            run = self._assert_current(session, warning=text)
            fall_back(session, run, sound, damaged)
            note(session, run, text, "warning")
        logger.warning("run %s: %s (%s)", self.run_id, text, ", ".join(damaged))
        self.generation, self.seconds = run.checkpoint_generation, run.seconds
        tell_rewind(self)
        announce(self.services, self.run_id)

    def record(self, report: Report, seconds: float) -> str | None:
        """Record a generation that took so many seconds; return the requested state."""
        total = self.seconds + seconds
        rows = recording.rows_of(report, total)
        with self.services.sessions.write.begin() as session:
            # After an outage nobody knows whether the same write was committed before it.
            new = self._assert_current(session).generation != rows.curve["generation"]
            standing = {**recording.standing(report), "seconds": total}
            requested = self._assert_current(session, **standing).requested_state
            if new:
                recording.write(session, self.run_id, rows)
        self.seconds = total
        self._tell(rows)
        return requested

    def requested(self) -> str | None:
        """Return the state that a person requests, `paused` or `cancelled`, if any."""
        with self.services.sessions.write.begin() as session:
            return self._assert_current(session).requested_state

    def save(self, generation: int, data: bytes) -> None:
        """Write the file of a recorded generation and make it the checkpoint.

        Raises `OSError` where it cannot be written; the previous one stays.
        """
        path = checkpoint_path(self.run_id, generation, data)
        self.point(generation, self.services.artifacts.write(path, data))

    def point(self, generation: int, stored: Stored) -> None:
        """Make a written file the checkpoint; files that nothing needs any more are deleted."""
        with self.services.sessions.write.begin() as session:
            before = self._assert_current(session)
            if generation > before.generation:
                raise ValueError(
                    "`generation` of a checkpoint must be recorded, that is at most "
                    f"{before.generation}; got {generation}"
                )
            superfluous = point_at(session, self.run_id, generation, stored)
            if generation > before.checkpoint_generation:
                self._assert_current(
                    session,
                    checkpoint_generation=generation,
                    attempts_without_checkpoint=0,
                    warning=None,
                )
            log.note_checkpoint(session, before, generation, stored.size)
        self.generation = generation
        for path in superfluous:
            try:
                self.services.artifacts.delete(path)
            except OSError as error:  # The new checkpoint stands all the same.
                logger.warning("a file that nothing needs stays: %s", error)

    def warn(self, text: str) -> None:
        """Say something on the run that people should know; the next checkpoint clears it."""
        self._end(text, "warning", UNSAVED, warning=text)

    def finish(self) -> None:
        ended = {"status": FINISHED, "finished_at": clock(), "error": None}
        self._end(None, **ended, requested_state=None, requested_at=None)

    def pause(self) -> None:
        self._end(f"Stopped after generation {self.generation}.", **_paused())

    def wait_for_override(self, text: str) -> None:
        """Pause until people say that another kind of device will do, by resuming it."""
        self._end(text, "warning", **_paused(), warning=text, device_override=OVERRIDE_NEEDED)

    def set_aside(self, text: str) -> None:
        """Pause until people have mended what this worker lacks, and resume it."""
        self._end(text, "warning", **_paused(), warning=text)

    def refuse(self, text: str) -> None:
        """Fail at once: what is wrong with it would be wrong in every attempt."""
        ended = {"status": FAILED, "finished_at": clock(), "error": text}
        self._end(text, "error", **ended, requested_state=None, requested_at=None)

    def cancel(self) -> None:
        ended = {"status": CANCELLED, "finished_at": clock()}
        self._end(None, **ended, requested_state=None, requested_at=None)

    def requeue(self) -> None:
        """Hand the run back in good order, as on SIGTERM: not one of the three chances."""
        with self.services.sessions.write.begin() as session:
            self._assert_current(session)
            hand_back(session, self.run_id)
        announce(self.services, self.run_id)

    def fail(self, error: str) -> None:
        """Keep the traceback; the run is queued for another attempt unless none is left."""
        with self.services.sessions.write.begin() as session:
            if not release(session, self.run_id, Run.attempt == self.attempt, error=error):
                raise ClaimLost(f"run {self.run_id}, attempt {self.attempt}")
        announce(self.services, self.run_id)

    def _end(
        self, text: str | None, level: Level = "info", kind: str | None = None, **values: Any
    ) -> None:
        """Change the run, and say in its journal why and how it stands."""
        with self.services.sessions.write.begin() as session:
            run = self._assert_current(session, **values)
            if text is not None:
                note(session, run, text, level, kind)
            if run.status != RUNNING:
                log.note_standing(session, run)
        announce(self.services, self.run_id)

    def _assert_current(self, session: Session, **values: Any) -> Run:
        """Change the row if this attempt is the current one, and hold it until the end."""
        mine = (Run.status == RUNNING, Run.attempt == self.attempt)
        run = change(session, self.run_id, *mine, **(values or {"attempt": self.attempt}))
        if run is None:
            raise ClaimLost(f"run {self.run_id}, attempt {self.attempt}")
        return run

    def _tell(self, rows: recording.Rows) -> None:
        for kind, data in recording.events(self.run_id, rows):
            self.services.events.publish(kind, self.run_id, data)
        if monotonic() - self.announced >= ANNOUNCE_EVERY:
            self.announced = monotonic()
            announce(self.services, self.run_id, without=["spec"])


def _paused() -> dict[str, Any]:
    """Unless people have meanwhile asked to cancel."""
    return {
        "status": func.coalesce(Run.requested_state, PAUSED),
        "finished_at": case((Run.requested_state == CANCELLED, clock()), else_=None),
        "worker": None,
        "requested_state": None,
        "requested_at": None,
    }


def tell_rewind(held: Claim) -> None:
    place = {"run": str(held.run_id), "generation": held.generation}
    held.services.events.publish("rewind", held.run_id, place)
