"""Position in the queue: why a run waits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from uuid import UUID, uuid4

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from ..core.database import now
from ..core.schemas import Wire
from ..schedule import take
from ..schedule.fit import fitting
from ..schedule.order import places
from ..schedule.take import runs_of
from ..services.services import Services
from ..tables import NORMAL, QUEUED, Run, Worker
from ..workers import registry

NO_WORKER = (
    "No worker is alive: start one with `make run` or "
    "`python -m microcosmos_worker.supervisor`."
)


class QueueAhead(Wire):
    runs_ahead: int
    """Queued runs that go first, without those that workers are about to start."""
    workers: int
    idle_workers: int


@dataclass(frozen=True)
class QueueState:
    """The number of queued runs, and the workers that take them."""

    moment: datetime
    queued: int
    taken: int
    """Number of queued runs that a worker has: they have the first places."""
    alive: list[Worker]
    """Live workers that take runs."""
    having: Mapping[str, UUID]
    """The run that a worker has, by the worker's name."""
    exhausted: Mapping[UUID | None, str]
    """The reason why no further run of an owner starts, by owner."""
    problem: str | None = None
    """The reason why no live worker takes runs; None if one does, or none is alive."""

    def idle(self, workers: Sequence[Worker]) -> int:
        return sum(worker.name not in self.having for worker in workers)


def queue_state(services: Services, session: Session) -> QueueState:
    alive = registry.live(session, services.settings.lease)
    able = [worker for worker in alive if worker.problem is None]
    problem = None if able or not alive else f"Worker {alive[0].name}: {alive[0].problem}."
    counts = select(func.count(Run.worker), func.count()).where(Run.status == QUEUED)
    taken, queued = session.execute(counts).one()
    return QueueState(
        moment=now(session),
        queued=queued,
        taken=taken,
        alive=able,
        having=runs_of(session, able),
        exhausted=take.exhausted(session),
        problem=problem,
    )


def ahead(
    services: Services, session: Session, owner: UUID | None, sweep: bool = False
) -> QueueAhead:
    """Return the queue ahead of a run, or a sweep, that its owner submits now."""
    queue = queue_state(services, session)
    # This row belongs to no session, so it is never written; it only gets a place.
    mine = Run(
        id=uuid4(),
        owner=owner,
        sweep=uuid4() if sweep else None,
        priority=NORMAL,
        interrupted=False,
        created_at=queue.moment,
        queued_at=queue.moment,
    )
    order = places(session, mine)
    place = session.execute(select(order.c.place).where(order.c.id == mine.id)).scalar_one()
    return QueueAhead(
        runs_ahead=place - 1 - queue.taken,
        workers=len(queue.alive),
        idle_workers=queue.idle(queue.alive),
    )


def reasons(services: Services, session: Session, runs: Sequence[Run]) -> dict[UUID, str]:
    """Return the reason why each queued run waits; read the queue only if there are any."""
    queued = [run for run in runs if run.status == QUEUED]
    if not queued:
        return {}
    queue, order = queue_state(services, session), places(session)
    mine = order.c.id.in_([run.id for run in queued])
    rows = session.execute(select(order.c.id, order.c.place).where(mine))
    found = {run_id: place for run_id, place in rows}
    return {run.id: reason(run, found.get(run.id, 1), queue) for run in queued}


def reason(run: Run, place: int, queue: QueueState) -> str:
    """Return a sentence about a run at this place of the queue, from 1."""
    if run.worker is not None:
        return f"Worker {run.worker} is about to start it."
    if not queue.alive:
        return queue.problem or NO_WORKER
    fit, unmet = fitting(run, queue.alive, queue.moment)
    if unmet:
        return unmet
    if over := queue.exhausted.get(run.owner):
        return over
    before = max(0, place - 1 - queue.taken)
    if queue.idle(fit):
        state = "A worker is free"
    elif len(fit) > 1:
        state = f"Waits for a worker: all {len(fit)} {which(fit, queue)}are busy"
    else:
        state = f"Waits for a worker: the only one {which(fit, queue)}is busy"
        state += f" with run {str(queue.having[fit[0].name])[:8]}"
    ahead = "1 run is before it" if before == 1 else f"{before:,} runs are before it"
    return f"{state}; {ahead if before else 'this run is next'}."


def which(fit: Sequence[Worker], queue: QueueState) -> str:
    return "" if len(fit) == len(queue.alive) else "that can carry it out "
