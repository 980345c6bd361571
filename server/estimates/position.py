"""Position in the queue: why a run waits."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from microcosmos.sizes import size

from ..queue.order import in_order
from ..services.services import Services
from ..specs.parsing import parse_stored
from ..tables import QUEUED, Run, Worker
from ..workers import plugins, registry
from .schemas import QueueAhead

NO_WORKER = "No worker is alive: start one with `make run` or `python -m worker.supervisor`."


@dataclass(frozen=True)
class QueueState:
    """The queued runs, and the workers that take them."""

    runs: list[UUID]
    """In the order in which workers take them."""
    alive: list[Worker]
    running: dict[str, Run]
    """By worker."""
    singles: int
    """Number of runs outside sweeps, which go before all others."""

    @property
    def busy(self) -> list[str]:
        return [worker.name for worker in self.alive if worker.status == "busy"]

    @property
    def idle(self) -> int:
        return len(self.alive) - len(self.busy)

    def before(self, place: int) -> int:
        """Return the number of runs before a place, from 0; negative if it is being taken.

        A busy worker without a run has taken one and prepares it.
        """
        return place - sum(name not in self.running for name in self.busy)

    def ahead(self, sweep: bool = False) -> QueueAhead:
        """Return the queue ahead of a run, or a sweep, that is submitted now."""
        before = max(0, self.before(len(self.runs) if sweep else self.singles))
        return QueueAhead(runs_ahead=before, workers=len(self.alive), idle_workers=self.idle)


def queue_state(services: Services, session: Session) -> QueueState:
    alive = registry.live(session, services.settings.lease)
    single = select(func.count()).where(Run.status == QUEUED, Run.sweep.is_(None))
    return QueueState(
        runs=[run.id for run in in_order(session)],
        alive=alive,
        running=registry.running(session, alive),
        singles=session.scalars(single).one(),
    )


def reasons(services: Services, session: Session, runs: Sequence[Run]) -> dict[UUID, str]:
    """Return why each of the queued ones waits; read the queue only if there are any."""
    queued = [run for run in runs if run.status == QUEUED]
    return reasons_in(queue_state(services, session), queued) if queued else {}


def reasons_in(queue: QueueState, queued: Sequence[Run]) -> dict[UUID, str]:
    places = {run_id: place for place, run_id in enumerate(queue.runs)}
    return {run.id: reason(run, places.get(run.id, 0), queue) for run in queued}


def reason(run: Run, place: int, queue: QueueState) -> str:
    """Return a sentence about a run at this place of the queue, from 0."""
    if not queue.alive:
        return NO_WORKER
    versions = run.plugin_versions
    fit = [worker for worker in queue.alive if plugins.has_versions(worker, versions)]
    if not fit:
        return plugins.explain_missing(queue.alive, run.spec)
    queue = replace(queue, alive=fit)
    before = queue.before(place)
    if before < 0:
        return "A worker is about to start it."
    needed, largest = needed_bytes(run), max(worker.memory_bytes for worker in queue.alive)
    if needed is not None and needed > largest:
        return f"Needs {size(needed)}; the largest live worker has {size(largest)}."
    if queue.idle:
        state = "A worker is free"
    elif len(queue.alive) > 1:
        state = f"Waits for a worker: all {len(queue.alive)} are busy"
    else:
        computed = queue.running.get(queue.alive[0].name)
        of_run = f" with run {str(computed.id)[:8]}" if computed else ""
        state = f"Waits for a worker: the only one is busy{of_run}"
    ahead = "1 run is before it" if before == 1 else f"{before:,} runs are before it"
    return f"{state}; {ahead if before else 'this run is next'}."


def needed_bytes(run: Run) -> int | None:
    """Return the memory that a run needs; None if another version wrote its spec."""
    found = parse_stored(run.spec)
    return found.estimate.memory_bytes if found else None
