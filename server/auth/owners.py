"""Whose things are."""

from collections.abc import Iterable
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from ..tables import Token


def names(session: Session, owners: Iterable[UUID | None]) -> dict[UUID | None, str]:
    """What owners are called; what nobody owns was made without a token."""
    wanted = {owner for owner in owners if owner is not None}
    if not wanted:
        return {}
    rows = session.execute(select(Token.id, Token.name).where(Token.id.in_(wanted)))
    return {identifier: name for identifier, name in rows}
