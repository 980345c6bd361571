"""Base class of wire types, and types of their fields."""

from datetime import UTC, datetime
from typing import Annotated

from pydantic import AfterValidator, AwareDatetime, BaseModel, ConfigDict

MAX_INTEGER = (1 << 31) - 1
"""Largest integer of a column; PostgreSQL refuses to compare larger ones."""


def _in_utc(moment: datetime) -> datetime:
    try:
        return moment.astimezone(UTC)
    except OverflowError:
        needed = "must lie within the years 1 to 9999 in UTC"
        raise ValueError(f"{needed}; got {moment.isoformat()}") from None


Moment = Annotated[AwareDatetime, AfterValidator(_in_utc)]
"""A point in time with its zone, which a sender may choose."""


class Wire(BaseModel):
    model_config = ConfigDict(extra="forbid", from_attributes=True)
