"""The device time that the runs of each owner have used."""

from datetime import datetime, timedelta
from uuid import UUID

from sqlalchemy import Select, delete, func, select
from sqlalchemy.orm import Session

from ..core.database import insert_or_update, now
from ..tables import NOBODY, DeviceUse


def count_device_time(session: Session, owner: UUID | None, seconds: float) -> None:
    """Add to the device time that an owner has used today."""
    row = {"owner": owner or NOBODY, "day": now(session).date(), "seconds": seconds}
    added = {"seconds": DeviceUse.seconds + seconds}
    insert_or_update(session, DeviceUse, [row], ("owner", "day"), added)


def forget_device_time(session: Session, before: datetime) -> int:
    """Delete the device time of days before a moment; return the number of rows."""
    old = delete(DeviceUse).where(DeviceUse.day < before.date()).returning(DeviceUse.day)
    return len(session.scalars(old).all())


def seconds_by_owner(session: Session, days: int) -> Select[UUID, float]:
    """Select each `owner` with its `seconds` of device time in the last days, today among them.

    `NOBODY` owns the runs without an owner.
    """
    first = (now(session) - timedelta(days=days - 1)).date()
    total = func.sum(DeviceUse.seconds).label("seconds")
    used = select(DeviceUse.owner, total).where(DeviceUse.day >= first)
    return used.group_by(DeviceUse.owner)


def device_seconds(session: Session, days: int) -> dict[UUID | None, float]:
    """Return the device time of each owner in the last days, today among them."""
    found = session.execute(seconds_by_owner(session, days))
    return {None if owner == NOBODY else owner: seconds for owner, seconds in found}
