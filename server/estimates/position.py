"""Why runs wait: the queue, and what those who work it off are at."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from microcosmos.sizes import size

from ..queue.order import in_order
from ..services.services import Services
from ..specs.stored import known
from ..tables import QUEUED, Run, Worker
from ..workers import plugins, registry
from .schemas import QueueAhead

NOBODY = "No worker is alive: start one with `make run` or `python -m worker.supervisor`."


@dataclass(frozen=True)
class Line:
    """The queue as it stands, and those who work it off."""

    runs: list[UUID]
    """Those that wait, in the order in which they are taken."""
    alive: list[Worker]
    at_work: dict[str, Run]
    """By worker."""
    singles: int
    """Runs of no sweep: these wait before all others."""

    @property
    def busy(self) -> list[str]:
        return [worker.name for worker in self.alive if worker.status == "busy"]

    @property
    def idle(self) -> int:
        """Workers that have nothing to do."""
        return len(self.alive) - len(self.busy)

    def before(self, place: int) -> int:
        """Runs that go before the one at a place, from 0; less than 0 where that is taken.

        Whoever is busy without a run has taken one and is getting ready for it.
        """
        return place - sum(name not in self.at_work for name in self.busy)

    def ahead(self, sweep: bool = False) -> QueueAhead:
        """What a run, or a sweep, that is submitted now will have to wait for."""
        before = max(0, self.before(len(self.runs) if sweep else self.singles))
        return QueueAhead(runs_ahead=before, workers=len(self.alive), idle_workers=self.idle)


def line(services: Services, session: Session) -> Line:
    alive = registry.live(session, services.settings.lease)
    single = select(func.count()).where(Run.status == QUEUED, Run.sweep.is_(None))
    return Line(
        runs=[run.id for run in in_order(session)],
        alive=alive,
        at_work=registry.at_work(session, alive),
        singles=session.scalars(single).one(),
    )


def reasons(services: Services, session: Session, runs: Sequence[Run]) -> dict[UUID, str]:
    """Why each of those that are queued waits. Where none is, nothing is asked."""
    queued = [run for run in runs if run.status == QUEUED]
    return reasons_in(line(services, session), queued) if queued else {}


def reasons_in(line: Line, queued: Sequence[Run]) -> dict[UUID, str]:
    """Why each of these runs waits in a line."""
    places = {run_id: place for place, run_id in enumerate(line.runs)}
    return {run.id: reason(run, places.get(run.id, 0), line) for run in queued}


def reason(run: Run, place: int, line: Line) -> str:
    """A sentence about a run at this place in the line, from 0."""
    if not line.alive:
        return NOBODY
    fit = [worker for worker in line.alive if plugins.fit(worker, run.plugin_versions)]
    if not fit:
        return plugins.missing(line.alive, run.spec)
    line = replace(line, alive=fit)
    before = line.before(place)
    if before < 0:
        return "A worker is about to begin."
    needed, largest = needed_bytes(run), max(worker.memory_bytes for worker in line.alive)
    if needed is not None and needed > largest:
        return f"Needs {size(needed)}; the largest live worker has {size(largest)}."
    held = "A worker is free" if line.idle else f"Waits for a worker: {_busy(line)}"
    return f"{held}; {_ahead(before)}."


def needed_bytes(run: Run) -> int | None:
    """The memory that a run asks for; None where another version wrote its spec."""
    found = known(run.spec)
    return found.needs.memory_bytes if found else None


def _busy(line: Line) -> str:
    if len(line.alive) > 1:
        return f"all {len(line.alive)} are busy"
    run = line.at_work.get(line.alive[0].name)
    return "the only one is busy" + (f" with run {str(run.id)[:8]}" if run else "")


def _ahead(before: int) -> str:
    if before == 0:
        return "this run is next"
    return "1 run is before it" if before == 1 else f"{before:,} runs are before it"
