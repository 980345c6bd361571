"""Quotas of owners."""

from uuid import UUID

from sqlalchemy import func, or_, select
from sqlalchemy.orm import Session

from ..auth.device_use import device_seconds
from ..core.errors import ProblemError
from ..tables import QUEUED, RUNNING, USE_DAYS, Run, Token


def refuse_too_many(session: Session, owner: UUID | None, added: int) -> None:
    """Raise `ProblemError` if an owner would have more queued runs than the quota allows."""
    token = session.get(Token, owner) if owner else None
    if token is None or token.max_queued is None:
        return
    mine = select(func.count()).where(Run.owner == owner, Run.status == QUEUED)
    queued = session.execute(mine).scalar_one()
    if queued + added > token.max_queued:
        detail = (
            f"`{token.name}` may have {token.max_queued:,} queued runs; it has {queued:,}, and "
            f"this request adds {added:,}."
        )
        raise ProblemError(429, "Too many queued runs", detail)


def exhausted(session: Session) -> dict[UUID | None, str]:
    """Return why no further run of some owners starts now, by owner."""
    limited = or_(Token.max_running.is_not(None), Token.device_hours.is_not(None))
    tokens = session.scalars(select(Token).where(limited)).all()
    if not tokens:
        return {}
    with_worker = or_(Run.status == RUNNING, (Run.status == QUEUED) & Run.worker.is_not(None))
    counts = select(Run.owner, func.count()).where(with_worker).group_by(Run.owner)
    running = {owner: number for owner, number in session.execute(counts)}
    used = device_seconds(session, USE_DAYS)
    found: dict[UUID | None, str] = {}
    for token in tokens:
        hours = used.get(token.id, 0.0) / 3600
        if token.max_running is not None and running.get(token.id, 0) >= token.max_running:
            runs = "1 run" if token.max_running == 1 else f"{token.max_running} runs"
            found[token.id] = f"Waits: `{token.name}` may compute {runs} at a time."
        elif token.device_hours is not None and hours >= token.device_hours:
            found[token.id] = (
                f"Waits: `{token.name}` has used {hours:.1f} of its {token.device_hours:g} "
                f"device hours in {USE_DAYS} days."
            )
    return found
