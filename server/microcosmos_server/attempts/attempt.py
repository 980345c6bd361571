"""An attempt at a run: the reads and writes of its worker."""

import logging
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from operator import itemgetter
from typing import Any
from uuid import UUID

from sqlalchemy import case, func, insert, select
from sqlalchemy.orm import Session

from microcosmos.archive.curves import CORRECTED
from microcosmos.archive.export import Terms
from microcosmos.archive.report import Report
from microcosmos.invalid import InvalidField
from microcosmos.naming import LICENCE
from microcosmos.sizes import size

from ..auth.device_use import count_device_time
from ..choices import choosing
from ..core.database import clock, retried
from ..core.errors import StoreUnavailable
from ..creatures import initial
from ..creatures.storage import creature_columns, insert_and_lock, link
from ..runs import log
from ..runs.announce import announce
from ..runs.curves import corrected_at
from ..runs.lifecycle import change, fail_attempt, stop_attempt
from ..services.services import Services
from ..storage import mark, segments, space
from ..storage.artifacts import checkpoint_path, patiently, reason
from ..storage.segments import Segments
from ..tables import (
    CANCELLED,
    FAILED,
    FINISHED,
    PAUSED,
    QUEUED,
    RUNNING,
    Elite,
    Generation,
    Result,
    Run,
    Worker,
)
from ..workers import totals
from .checkpoints import add_checkpoint, fall_back, newest_intact

COLUMNS = ("cell", "generation", "fitness", "descriptors", "creature")
"""Columns of elites, but for the run."""


@dataclass(frozen=True)
class Rows:
    """The rows of a report, without the id of the run."""

    run: dict[str, Any]
    """Columns of the run itself."""
    curve: dict[str, Any]
    elites: list[dict[str, Any]]
    emptied: list[int]
    """Cells that lost their elite and have no new one."""
    results: list[dict[str, Any]]
    """Without their number, which depends on the rows that the table holds."""
    creatures: list[dict[str, Any]]


def rows_of(report: Report, seconds: float, terms: Terms) -> Rows:
    """Convert a report of a run under some terms; `seconds` is its wall time so far."""
    elites = [(elite, elite.poses) for elite in report.elites]
    found = [*elites, *((row, None) for row in report.rows if row.creature is not None)]
    summary = json_values(report.summary)
    run = {
        "generation": int(report.generation),
        "qd_score": finite(report.qd_score),
        "coverage": finite(report.coverage),
        "best": finite(report.best),
        "evaluations": int(report.evaluations),
        "infeasible": int(report.infeasible),
        "seconds": seconds,
    }
    changed = {} if summary is None else {"summary": summary}
    known = summary or {}
    changed |= {name: known[name] for name in CORRECTED if name in known}
    return Rows(
        run=run | changed,
        curve={**run, "mean": finite(report.mean), "summary": summary},
        elites=[
            {
                "cell": int(elite.cell),
                "generation": int(elite.generation),
                "fitness": float(elite.fitness),
                "descriptors": [float(value) for value in elite.descriptors],
                "creature": elite.creature,
            }
            for elite in report.elites
        ],
        emptied=sorted(int(cell) for cell in report.emptied),
        results=[
            {
                "generation": run["generation"],
                "values": json_values(row.values),
                "creature": row.creature,
            }
            for row in report.rows
        ],
        creatures=[
            creature_columns(one.creature, one.identity, one.measured, one.provenance, LICENCE)
            | terms
            | {"poses": poses}
            for one, poses in found
        ],
    )


def finite(value: float | None) -> float | None:
    """Return the value, or None where JSON and SQL cannot hold it (NaN, infinity)."""
    return value if value is not None and math.isfinite(value) else None


def json_values(values: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """Replace numbers that are not finite by None, for JSON."""
    if values is None:
        return None
    return {
        name: finite(value) if isinstance(value, float) else value
        for name, value in values.items()
    }


def write(session: Session, run_id: UUID, rows: Rows) -> None:
    session.execute(insert(Generation), [{"run_id": run_id, **rows.curve}])
    # Sorted, so that two runs with the same creatures cannot deadlock.
    found = sorted(rows.creatures, key=itemgetter("sha256"))
    insert_and_lock(session, found)
    link(session, [row["sha256"] for row in found])
    # Rows are added, never changed: archives of earlier generations are read from them.
    if changed := [*rows.elites, *_losses(rows)]:
        session.execute(insert(Elite), [{"run_id": run_id, **row} for row in changed])
    if rows.results:
        first = count_results(session, run_id)
        placed = [
            {"run_id": run_id, "number": first + i, **row} for i, row in enumerate(rows.results)
        ]
        session.execute(insert(Result), placed)


def _losses(rows: Rows) -> list[dict[str, Any]]:
    """Return a row without a creature for each cell that lost its elite."""
    row = dict.fromkeys(COLUMNS) | {"generation": rows.curve["generation"]}
    return [{**row, "cell": cell} for cell in rows.emptied]


def count_results(session: Session, run_id: UUID) -> int:
    mine = select(func.count()).select_from(Result).where(Result.run_id == run_id)
    return session.execute(mine).scalar_one()


def events(run_id: UUID, rows: Rows) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield kind and data of the events of a generation."""
    head = {"run": str(run_id), "generation": rows.curve["generation"]}
    yield "generation", head | rows.curve
    if rows.elites or rows.emptied:
        columns = {name: [row[name] for row in rows.elites] for name in COLUMNS}
        columns |= {"elite_generation": columns["generation"], "emptied": rows.emptied}
        yield "elites", columns | head
    if rows.results:
        table = [{**row["values"], "creature": row["creature"]} for row in rows.results]
        yield "results", head | {"summary": rows.curve["summary"], "rows": table}


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
    """Seconds for which it waits for a database or store that does not answer."""
    requested_state: str | None = None
    """The state in which a person, or an urgent run, wants the run: see `Run`."""
    recorded: bool = False
    """The attempt has recorded a generation."""
    terms: Terms = field(default_factory=dict)
    """Licence and credit of what the run descends from, which its creatures and files have."""
    segments: Segments = field(default_factory=Segments)
    """Segments that this attempt may name again."""
    checked_at: float = field(default_factory=time.monotonic)
    announced_at: float = 0.0

    def __post_init__(self) -> None:
        # Save the first generation at once: its file holds the centroids of a CVT.
        self.saved_at = time.monotonic() if self.generation else -math.inf
        self.unsaved = ""
        """Why the last checkpoint could not be written."""
        self.device: str | None = None

    def record_device(self, device: str, sinks: Sequence[str] = ()) -> None:
        """Record the kind of device that computes the run from here on, and its sinks.

        Where the run may have changed its kind, the next checkpoint records it: if the attempt
        ends before, the file goes on with the bits of the earlier one.
        """
        self.device = device
        copied = f" Curves and files also go to {', '.join(sinks)}." if sinks else ""
        known: dict[str, Any] = (
            {} if self.other_device and self.generation else {"device": device}
        )
        self._update(f"Computing on {device}.{copied}", sinks=list(sinks), **known)

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
        found = patiently(
            lambda: newest_intact(self.services, self.run_id),
            self.outage_seconds,
            self.interrupted,
        )
        intact, damaged = found.row, found.damaged
        self.segments.begin_from(found.segments)
        if intact and (damaged or intact.generation != self.generation):
            text = (
                f"The checkpoint of generation {self.generation} is damaged; "
                f"the run resumes from generation {intact.generation}."
            )
            with self.current(warning=text) as (session, run):
                # After an outage an earlier try may have been committed.
                if damaged:
                    fall_back(session, run, intact, damaged)
                    log.note(session, run, text, "warning")
            logger.warning("run %s: %s (%s)", self.run_id, text, ", ".join(damaged))
            self.generation, self.seconds = run.checkpoint_generation, run.seconds
            self.work = (run.evaluations, run.infeasible)
            self.publish_rewind()
            announce(self.services, self.run_id)
        return found.data

    def take_back(self, evaluations: int) -> None:
        """Correct the last generation of a run that had ended, and was extended since.

        A search whose end is not on the schedule of its reevaluations evaluates its elites once
        more. If it goes on, that did not happen; `evaluations` are then fewer.
        """
        if evaluations != self.work[0]:
            self._take_back(evaluations)
            self.work = (evaluations, self.work[1])

    @retried
    def _take_back(self, evaluations: int) -> None:
        with self.current(evaluations=evaluations) as (session, run):
            row = session.get_one(Generation, (self.run_id, self.generation))
            row.evaluations = evaluations
            figures = row.summary or {}
            row.summary = {name: figures[name] for name in figures if name not in CORRECTED}
            run.summary = row.summary
            session.flush()
            for name, value in corrected_at(session, self.run_id, self.generation).items():
                setattr(run, name, value)

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
        rows = rows_of(report, total, self.terms)
        with self.current(**rows.run) as (session, run):
            # After an outage an earlier try may have been committed.
            if session.get(Generation, (self.run_id, report.generation)) is None:
                write(session, self.run_id, rows)
                count_device_time(session, run.owner, seconds)
                totals.count_work(session, run, self.work, seconds)
            self.requested_state = run.requested_state
        self.seconds, self.recorded = total, True
        self.work = (rows.run["evaluations"], rows.run["infeasible"])
        # After the commit: an event must not tell of rows that were rolled back.
        for kind, data in events(self.run_id, rows):
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
        # Before the try: after a failure the next one waits for the interval, too.
        self.saved_at = time.monotonic()
        try:
            patiently(lambda: self.save(generation, data), patience, self.interrupted)
        except OSError as error:
            logger.warning("No checkpoint of generation %s: %s", generation, error)
            self.unsaved = (
                f"The checkpoint of generation {generation} could not be written "
                f"({reason(error)}). The one of generation {self.generation} stays"
            )
            text = f"{self.unsaved}; the worker will try again."
            self.warn(text, totals.CHECKPOINT_FAILURES)
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
        # Files before their rows: a row must not name a file that is not whole. After a crash
        # in between, the files go with the folder of their run.
        limit = self.services.settings.segment_bytes
        written = segments.write(self.services.artifacts, path, data, self.segments, limit)
        with self.current() as (session, run):
            if generation > run.generation:
                raise InvalidField(
                    "generation",
                    "of a checkpoint must be recorded, that is at most "
                    f"{run.generation}; got {generation}",
                )
            add_checkpoint(session, self.run_id, generation, written)
            # Only progress resets the count: a run that saves the same generation again and
            # again would be tried for ever (tests/server/attempts/test_checkpoints.py).
            if generation > run.checkpoint_generation:
                run.checkpoint_generation = generation
                run.attempts_without_checkpoint = 0
                run.device = self.device or run.device
                run.warning = None
            text = f"Checkpoint of generation {generation} written, {size(len(data))}."
            log.note(session, run, text, kind=log.SAVED)
        self.generation = generation
        self.segments.recorded |= {one.path for one in written.new}

    def end(self, done: bool, generation: int, save: Callable[[], bytes]) -> None:
        """Checkpoint the last whole generation and end the attempt.

        If the last checkpoint cannot be written, a later attempt computes again what was not
        saved: by itself if the store is away, else once a person resumes the run.
        """
        saved = generation == self.generation or self.checkpoint(
            generation, save(), self.outage_seconds
        )
        if self.requested_state is not None:
            self.read_request()  # It may have been taken back.
        if done and saved:
            self.finish()
        elif self.requested_state == CANCELLED:
            self.cancel()
        elif self.requested_state == PAUSED:
            self.pause()
        elif done and not self.store_fault():
            self.pause_until_resumed(f"{self.unsaved}. Make room for it")
        else:
            self.requeue()

    def warn(self, text: str, counted: totals.Key | None = None) -> None:
        """Show a warning on the run; the next checkpoint that is written clears it."""
        self._update(text, "warning", log.UNSAVED, counted, warning=text)

    def finish(self) -> None:
        self._update(None, **ended(FINISHED), error=None, error_details=None)

    def cancel(self) -> None:
        self._update(None, **cancelled())

    def refuse(self, text: str) -> None:
        """Fail at once: every other attempt would fail, too."""
        self._update(text, "error", **ended(FAILED), error=text, error_details=None)

    def pause(self) -> None:
        self._update(f"Stopped after generation {self.generation}.", **paused(warning=None))

    def pause_until_resumed(self, reason: str, **values: Any) -> None:
        """Pause until a person adds the missing plug-in or file and resumes the run."""
        text = f"{reason.rstrip('.')}. Then resume the run."
        self._update(text, "warning", **paused(text), **values)

    def store_fault(self) -> str | None:
        """Return the fault of the store, if any. A lost mount looks like an empty store."""
        return mark.fault(self.services.sessions, self.services.artifacts)

    @retried
    def listed_plugins(self) -> list[dict[str, Any]]:
        """Return the plug-ins that the worker had when it last reported."""
        with self.current() as (session, run):
            worker = session.get(Worker, run.worker)
            return list(worker.plugins) if worker else []

    @retried
    def requeue(self) -> None:
        """Return the run to the queue, as on SIGTERM: this is not a failed attempt."""
        with self.current() as (session, _):
            stop_attempt(session, self.run_id)
        announce(self.services, self.run_id)
        self.services.wake.send()

    def fail(self, error: str, details: str | None = None) -> None:
        """Record the error and its traceback, and requeue the run unless no attempt is left."""
        with self.services.sessions.write.begin() as session:
            mine = Run.attempt == self.number
            if not fail_attempt(
                session, self.run_id, mine, error=error, details=details, reason="error"
            ):
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
            # An UPDATE even without new values: it locks the row, so that no other attempt
            # begins before this transaction ends (tests/server/attempts/test_claims.py).
            run = change(session, self.run_id, *mine, **(values or {"attempt": self.number}))
            if run is None:
                raise ClaimLost(f"run {self.run_id}, attempt {self.number}")
            yield session, run


def ended(status: str) -> dict[str, Any]:
    return {
        "status": status,
        "finished_at": clock(),
        "requested_state": None,
        "requested_at": None,
    }


def cancelled() -> dict[str, Any]:
    """Return the values of a cancelled run, or of a queued or paused one if that was undone."""
    asked = Run.requested_state == CANCELLED
    return {
        "status": func.coalesce(Run.requested_state, QUEUED),
        "finished_at": case((asked, clock()), else_=None),
        "worker": case((asked, Run.worker), else_=None),
        "interrupted": Run.requested_state.is_(None),
        "released_at": clock(),
        "requested_state": None,
        "requested_at": None,
    }


def paused(warning: str | None) -> dict[str, Any]:
    """Return the values of a paused run, or of a cancelled one if that was requested.

    With a warning the run waits for a person.
    """
    return {
        "status": case((Run.requested_state == CANCELLED, CANCELLED), else_=PAUSED),
        "finished_at": case((Run.requested_state == CANCELLED, clock()), else_=None),
        "worker": None,
        "released_at": clock(),
        "requested_state": None,
        "requested_at": None,
        "warning": warning,
    }


@retried
def begin_choices(attempt: Attempt, generation: int) -> list[dict[str, Any]]:
    """Return the files of creatures that count from a generation on, before it is computed.

    Later choices count from another generation, even if this one is repeated.
    """
    with attempt.current() as (session, run):
        return initial.files(session, choosing.begin(session, run, generation))


@retried
def forget_choices(attempt: Attempt, generation: int, creatures: Sequence[str]) -> None:
    """Delete choices of creatures that the run no longer has."""
    with attempt.current() as (session, run):
        choosing.forget(session, run, generation, creatures)
