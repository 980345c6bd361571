"""An attempt at a run: the reads and writes of its worker."""

import logging
import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any
from uuid import UUID

from sqlalchemy.orm import Session

from microcosmos.archive.report import Report
from microcosmos.sizes import size

from ..auth.device_use import count_device_time
from ..core.database import retried
from ..core.errors import StoreUnavailable
from ..creatures import initial
from ..runs import log
from ..runs.announce import announce
from ..runs.lifecycle import change, fail_attempt, stop_attempt
from ..services.services import Services
from ..storage import mark, space
from ..storage.artifacts import checkpoint_path
from ..storage.patience import patiently
from ..tables import CANCELLED, FAILED, FINISHED, PAUSED, RUNNING, Generation, Run
from ..workers import totals
from . import recording
from .checkpoints import add_checkpoint, fall_back, newest_intact
from .ending import ended, paused

logger = logging.getLogger(__name__)

ANNOUNCE_SECONDS = 1.0
"""Least time between two events that describe the whole run."""
CHECK_SECONDS = 1.0
"""Least time between two reads of the requested state."""


class ClaimLost(Exception):
    """The run has ended, or another attempt has claimed it."""


@dataclass
class Attempt:
    """An attempt at a run; each write raises `ClaimLost` unless the attempt is current."""

    services: Services
    run_id: UUID
    number: int
    spec: dict[str, Any]
    generation: int
    """Generation of the last checkpoint; 0 without one."""
    seconds: float
    """Wall time of the recorded generations."""
    work: tuple[int, int] = (0, 0)
    """Evaluations of the recorded generations, and how many of them are infeasible."""
    other_device: bool = False
    """The run may continue on another kind of device than the one that started it."""
    stop_requested: Callable[[], bool] = lambda: False
    """Returns True once the worker has to stop."""
    outage_seconds: float = 0.0
    """Seconds that it waits while the database or the store is away."""
    requested_state: str | None = None
    """The state in which a person, or an urgent run, wants the run: see `Run`."""
    recorded: bool = False
    """It has recorded a generation."""
    checked_at: float = field(default_factory=time.monotonic)
    announced_at: float = 0.0

    def __post_init__(self) -> None:
        # Save the first generation at once: its file holds the centroids of a CVT.
        self.saved_at = time.monotonic() if self.generation else -math.inf

    def record_device(self, device: str, sinks: Sequence[str] = ()) -> None:
        """Record the kind of device that computes the run from here on, and its sinks."""
        copied = f" Curves and files also go to {', '.join(sinks)}." if sinks else ""
        self._update(f"Computing on {device}.{copied}", device=device, sinks=list(sinks))

    @retried
    def initial(self) -> list[dict[str, Any]]:
        names = self.spec.get("search", {}).get("initial", [])
        with self.services.sessions.read() as session:
            return initial.files(session, names)

    @retried
    def restore(self) -> bytes | None:
        """Return the content of the newest intact checkpoint; None before the first one.

        Older checkpoints stand in for damaged ones, and what was recorded after them is
        deleted. Raise `CheckpointUnavailable`, and delete nothing, if a file is missing or all
        are damaged: then the store may be the wrong one, and a person has to decide. Raise
        `StoreUnavailable` if one cannot be read for long. Call it before anything is recorded.
        """
        data, intact, damaged = patiently(
            lambda: newest_intact(self.services, self.run_id),
            self.outage_seconds,
            self.interrupted,
        )
        if intact and damaged:
            text = (
                f"The checkpoint of generation {self.generation} is damaged; "
                f"the run resumes from generation {intact.generation}."
            )
            with self.current(warning=text) as (session, run):
                fall_back(session, run, intact, damaged)
                log.note(session, run, text, "warning")
            logger.warning("run %s: %s (%s)", self.run_id, text, ", ".join(damaged))
            self.generation, self.seconds = run.checkpoint_generation, run.seconds
            self.work = (run.evaluations, run.infeasible)
            self.publish_rewind()
            announce(self.services, self.run_id)
        return data

    def publish_rewind(self) -> None:
        place = {"run": str(self.run_id), "generation": self.generation}
        self.services.events.publish("rewind", self.run_id, place)

    def interrupted(self) -> bool:
        """Return True if the attempt has to stop; experiments call this between blocks."""
        now = time.monotonic()
        if self.requested_state is None and now - self.checked_at >= CHECK_SECONDS:
            self.checked_at = now
            self.read_request()
        return self.requested_state is not None or self.stop_requested()

    @retried
    def read_request(self) -> None:
        with self.current() as (_, run):
            self.requested_state = run.requested_state

    @retried
    def record(self, report: Report, seconds: float) -> None:
        total = self.seconds + seconds
        rows = recording.rows_of(report, total)
        with self.current(**rows.run) as (session, run):
            # After an outage an earlier try may have been committed.
            if session.get(Generation, (self.run_id, report.generation)) is None:
                recording.write(session, self.run_id, rows)
                count_device_time(session, run.owner, seconds)
                totals.count_work(session, run, self.work, seconds)
            self.requested_state = run.requested_state
        self.seconds, self.recorded = total, True
        self.work = (rows.run["evaluations"], rows.run["infeasible"])
        for kind, data in recording.events(self.run_id, rows):
            self.services.events.publish(kind, self.run_id, data)
        if time.monotonic() - self.announced_at >= ANNOUNCE_SECONDS:
            self.announced_at = time.monotonic()
            announce(self.services, self.run_id, without=["spec"])

    def checkpoint_due(self) -> bool:
        return time.monotonic() - self.saved_at >= self.services.settings.checkpoint_interval

    def checkpoint(self, generation: int, data: bytes, patience: float = 0.0) -> bool:
        """Save a recorded generation. If that fails, warn on the run and return False.

        `patience` is the time, in seconds, to wait for a store that does not answer.
        """
        self.saved_at = time.monotonic()
        try:
            patiently(lambda: self.save(generation, data), patience, self.interrupted)
        except OSError as error:
            logger.warning("No checkpoint of generation %s: %s", generation, error)
            self.warn(
                f"The checkpoint of generation {generation} could not be written ({error}). "
                f"The one of generation {self.generation} stays; the worker will try again.",
                totals.CHECKPOINT_FAILURES,
            )
            return False
        if warning := space.shortage(self.services.settings, self.services.artifacts):
            self.warn(f"{warning}.")
        return True

    @retried
    def save(self, generation: int, data: bytes) -> None:
        """Write the file of a recorded generation and make it the newest checkpoint.

        Raise `OSError` if it cannot be written; the previous one stays.
        """
        if fault := self.store_fault():
            raise StoreUnavailable(fault)
        path = checkpoint_path(self.run_id, self.number, generation, data)
        stored = self.services.artifacts.write(path, data)
        with self.current() as (session, run):
            if generation > run.generation:
                raise ValueError(
                    "`generation` of a checkpoint must be recorded, that is at most "
                    f"{run.generation}; got {generation}"
                )
            add_checkpoint(session, self.run_id, generation, stored)
            if generation > run.checkpoint_generation:
                run.checkpoint_generation = generation
                run.attempts_without_checkpoint = 0
                run.warning = None
            text = f"Checkpoint of generation {generation} written, {size(stored.size)}."
            log.note(session, run, text, kind=log.SAVED)
        self.generation = generation

    def end(self, done: bool, generation: int, save: Callable[[], bytes]) -> None:
        """Checkpoint the last whole generation and end the attempt.

        If the last checkpoint cannot be written, a later attempt computes again what was not
        saved: by itself if the store is away, else once a person resumes the run.
        """
        saved = generation == self.generation or self.checkpoint(
            generation, save(), self.outage_seconds
        )
        if done and saved:
            self.finish()
        elif self.requested_state == CANCELLED:
            self.cancel()
        elif self.requested_state == PAUSED:
            self.pause()
        elif done and not self.store_fault():
            self.pause(warning=Run.warning)  # It says why: a person has to act.
        else:
            self.requeue()

    def warn(self, text: str, counted: totals.Key | None = None) -> None:
        """Show a warning on the run; the next checkpoint that is written clears it."""
        self._update(text, "warning", log.UNSAVED, counted, warning=text)

    def finish(self) -> None:
        self._update(None, **ended(FINISHED), error=None)

    def cancel(self) -> None:
        self._update(None, **ended(CANCELLED))

    def refuse(self, text: str) -> None:
        """Fail at once: every other attempt would fail, too."""
        self._update(text, "error", **ended(FAILED), error=text)

    def pause(self, **values: Any) -> None:
        self._update(f"Stopped after generation {self.generation}.", **paused(), **values)

    def pause_until_resumed(self, reason: str, **values: Any) -> None:
        """Pause until a person adds the missing plug-in or file and resumes the run."""
        text = f"{reason.rstrip('.')}. Then resume the run."
        self._update(text, "warning", **paused(), warning=text, **values)

    def store_fault(self) -> str | None:
        """Return why the store cannot be read and written now; a lost mount is empty."""
        return mark.fault(self.services.sessions, self.services.artifacts)

    @retried
    def requeue(self) -> None:
        """Return the run to the queue, as on SIGTERM: this is not a failed attempt."""
        with self.current() as (session, _):
            stop_attempt(session, self.run_id)
        announce(self.services, self.run_id)
        self.services.wake.send()

    def fail(self, error: str) -> None:
        """Record the traceback, and requeue the run unless this was its last attempt."""
        with self.services.sessions.write.begin() as session:
            mine = Run.attempt == self.number
            if not fail_attempt(session, self.run_id, mine, error=error, reason="error"):
                raise ClaimLost(f"run {self.run_id}, attempt {self.number}")
        announce(self.services, self.run_id)
        self.services.wake.send()

    @retried
    def _update(
        self,
        text: str | None,
        level: log.Level = "info",
        kind: str | None = None,
        counted: totals.Key | None = None,
        **values: Any,
    ) -> None:
        """Change the run, log the reason, and count; log its status if the attempt ends."""
        with self.current(**values) as (session, run):
            if text is not None:
                log.note(session, run, text, level, kind)
            if run.status != RUNNING:
                log.note_status(session, run)
            if counted is not None:
                totals.count(session, run.worker, counted)
        announce(self.services, self.run_id)

    @contextmanager
    def current(self, **values: Any) -> Iterator[tuple[Session, Run]]:
        """Begin a transaction, lock and change the run if the attempt is the current one."""
        with self.services.sessions.write.begin() as session:
            mine = (Run.status == RUNNING, Run.attempt == self.number)
            run = change(session, self.run_id, *mine, **(values or {"attempt": self.number}))
            if run is None:
                raise ClaimLost(f"run {self.run_id}, attempt {self.number}")
            yield session, run
