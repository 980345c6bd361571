"""Outbox: notifications that wait in the database until they are sent.

They are written in the transaction that changes the run, whether a webhook is set or not:
workers do not know its address. The server takes them, and discards them where none is set.
"""

from datetime import timedelta
from uuid import UUID

from sqlalchemy import delete, func, select, update
from sqlalchemy.orm import Session

from ..core.database import clock, now
from ..services.services import Services
from ..tables import CANCELLED, PAUSED, Notification, Run
from ..workers import totals

FIRST_PAUSE, LONGEST_PAUSE = 5.0, 3600.0
"""Seconds before the second try; each further pause is twice as long, up to the longest."""
LIFETIME = timedelta(days=3)
"""Time after which a notification that nobody accepts is discarded."""
UNDO = timedelta(seconds=10)
"""Time in which a cancellation can be taken back before anybody is told."""
REASON_LENGTH = 500
"""Largest number of characters of a reason."""
COLUMNS = ("name", "experiment", "status", "generation", "generations", "attempt")
DELIVERED, DISCARDED, FAILED = (
    totals.Key(totals.WEBHOOK, outcome) for outcome in ("delivered", "discarded", "failed")
)

OUTCOMES = (DELIVERED, DISCARDED, FAILED)


def add(session: Session, run: Run) -> None:
    """Add a notification of the state that a run has from this transaction on."""
    reason = run.warning if run.status == PAUSED else run.error
    reason = reason and reason[:REASON_LENGTH]
    data = {name: getattr(run, name) for name in COLUMNS} | {"reason": reason}
    data |= {"sweep": str(run.sweep) if run.sweep else None}
    due = now(session) + (UNDO if run.status == CANCELLED else timedelta())
    session.add(Notification(run_id=run.id, kind=f"run.{run.status}", data=data, due_at=due))


def withdraw(session: Session, run_id: UUID) -> None:
    """Delete the notification that a run is cancelled, unless it was sent already."""
    mine = (Notification.run_id == run_id, Notification.kind == f"run.{CANCELLED}")
    session.execute(delete(Notification).where(*mine, Notification.tries == 0))


def take(services: Services) -> Notification | None:
    """Return the next notification that is due; it is due again after a pause.

    Only one of several servers gets it. The first try also counts the event itself.
    """
    with services.sessions.read() as session:  # Usually there is none, and nobody has to wait.
        if (
            session.scalar(select(Notification.id).where(Notification.due_at <= clock()))
            is None
        ):
            return None
    with services.sessions.write.begin() as session:
        moment = now(session)
        due = select(Notification).where(Notification.due_at <= moment)
        found = session.scalars(due.order_by(Notification.due_at, Notification.id).limit(1))
        one = found.one_or_none()
        if one is None:
            return None
        pause = min(LONGEST_PAUSE, FIRST_PAUSE * 2.0 ** min(one.tries, 30))
        mine = (Notification.id == one.id, Notification.tries == one.tries)
        later = {"tries": one.tries + 1, "due_at": moment + timedelta(seconds=pause)}
        taken = update(Notification).where(*mine).values(**later).returning(Notification.id)
        if session.scalars(taken).one_or_none() is None:
            return None
        session.refresh(one)
        if one.tries == 1:
            ended = totals.Key(totals.RUNS_ENDED, one.data["status"])
            totals.add(session, "", {ended: 1.0})
        return one


def settle(services: Services, one: Notification, outcome: totals.Key | None) -> None:
    """Count the outcome of a try; delete the notification unless it will be tried again."""
    with services.sessions.write.begin() as session:
        if outcome == FAILED and now(session) - one.created_at >= LIFETIME:
            outcome = DISCARDED
        if outcome != FAILED:
            session.execute(delete(Notification).where(Notification.id == one.id))
        if outcome is not None:
            totals.add(session, "", {outcome: 1.0})


def waiting(session: Session) -> tuple[int, float]:
    """Return the number of notifications, and the age in seconds of the oldest."""
    count, oldest = session.execute(
        select(func.count(), func.min(Notification.created_at))
    ).one()
    return count, (now(session) - oldest).total_seconds() if oldest else 0.0
