"""Outbox: notifications that wait in the database until they are sent.

They are written in the transaction that changes the run, whether a webhook is set or not:
workers do not know its address. The server takes them, and discards them where none is set.
"""

from datetime import timedelta

from sqlalchemy import delete, func, select, update
from sqlalchemy.orm import Session

from ..core.database import clock, now
from ..services.services import Services
from ..tables import PAUSED, Notification, Run
from ..workers import totals

FIRST_PAUSE, LONGEST_PAUSE = 5.0, 3600.0
"""Seconds before the second try; each further pause is twice as long, up to the longest."""
LIFETIME = timedelta(days=3)
"""Time after which a notification that nobody accepts is discarded."""
REASON_LENGTH = 500
"""Largest number of characters of a reason."""
COLUMNS = ("name", "experiment", "status", "generation", "generations", "attempt")
DELIVERED, DISCARDED, FAILED = (
    totals.Key(totals.WEBHOOK, outcome) for outcome in ("delivered", "discarded", "failed")
)

OUTCOMES = (DELIVERED, DISCARDED, FAILED)


def add(session: Session, run: Run) -> None:
    """Add a notification of the state that a run has from this transaction on."""
    text = (run.warning if run.status == PAUSED else run.error) or ""
    reason = text.strip().rpartition("\n")[2][-REASON_LENGTH:] or None
    data = {name: getattr(run, name) for name in COLUMNS} | {"reason": reason}
    data |= {"sweep": str(run.sweep) if run.sweep else None}
    session.add(Notification(run_id=run.id, kind=f"run.{run.status}", data=data))


def take(services: Services) -> Notification | None:
    """Return the next notification that is due; it is due again after a pause.

    Of several servers one gets it. What is taken for the first time is counted.
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
            status = one.kind.removeprefix("run.")
            totals.add(session, "", {totals.Key(totals.RUNS_ENDED, status): 1.0})
        return one


def settle(services: Services, one: Notification, outcome: totals.Key | None) -> None:
    """Count the outcome of a try; forget the notification unless it is to be tried again."""
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
