"""Lists of runs: which, in which order, and pages that stay right under any order."""

import json
import math
import re
from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any, Literal
from uuid import UUID

from sqlalchemy import (
    ColumnElement,
    Double,
    Row,
    Select,
    and_,
    case,
    cast,
    func,
    or_,
    select,
    true,
)
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.orm import Session
from sqlalchemy.sql.functions import GenericFunction

from ..core.errors import ProblemError, brief
from ..core.schemas import FieldError
from ..tables import FINISHED, STATUSES, Run
from .lifecycle import KEPT

Sort = Literal[
    "created", "-created", "started", "-started", "finished", "-finished",
    "name", "-name", "experiment", "-experiment", "status", "-status",
    "progress", "-progress", "evaluations", "-evaluations",
    "qd_score", "-qd_score", "coverage", "-coverage", "best", "-best",
]  # fmt: skip

KEYS: dict[str, ColumnElement[Any]] = {
    "created": Run.created_at.expression,
    "started": Run.started_at.expression,
    "finished": Run.finished_at.expression,
    "name": func.lower(Run.name),
    "experiment": Run.experiment.expression,
    "status": case({name: place for place, name in enumerate(STATUSES)}, value=Run.status),
    "progress": case(
        (Run.status == FINISHED, 1.0), else_=cast(Run.generation, Double) / Run.generations
    ),
    "evaluations": Run.evaluations.expression,
    "qd_score": Run.qd_score.expression,
    "coverage": Run.coverage.expression,
    "best": Run.best.expression,
}
MOMENTS, TEXTS = ("created", "started", "finished"), ("name", "experiment")
WHOLE = {"status": len(STATUSES), "evaluations": 1 << 63}
"""Whole numbers, which are less than these."""
LISTED = Row[Run, Any]


class members(GenericFunction[str]):
    """The texts in a JSON array, a row each, in the column `value`."""

    inherit_cache = True


@compiles(members, "sqlite")
def _sqlite_members(element: members, compiler: Any, **options: Any) -> str:
    return f"json_each({compiler.process(element.clauses, **options)})"


@compiles(members, "postgresql")
def _postgresql_members(element: members, compiler: Any, **options: Any) -> str:
    return f"json_array_elements_text({compiler.process(element.clauses, **options)})"


def matching(
    statement: Select[Run],
    statuses: Sequence[str],
    experiments: Sequence[str],
    tag: str | None,
    text: str | None,
    sweep: UUID | Literal["none"] | None = None,
    deleted: bool = False,
) -> Select[Run]:
    """The runs of any of the states and experiments, with the tag and the text, of a sweep;
    those in the bin, or those that are not.
    """
    statement = statement.where(Run.deleted_at.is_not(None) if deleted else KEPT)
    if statuses:
        statement = statement.where(Run.status.in_(statuses))
    if experiments:
        statement = statement.where(Run.experiment.in_(experiments))
    if tag is not None:
        statement = statement.where(_tagged(lambda value: value == tag))
    if sweep is not None:
        statement = statement.where(Run.sweep == (None if sweep == "none" else sweep))
    wanted = (text or "").strip()
    return statement.where(_says(wanted)) if wanted else statement


def _tagged(condition: Any) -> ColumnElement[bool]:
    value = members(Run.tags).table_valued("value")
    return select(value.c.value).where(condition(value.c.value)).exists()


def _says(text: str) -> ColumnElement[bool]:
    """Wildcards in the text mean themselves."""
    inside = [column.icontains(text, autoescape=True) for column in (Run.name, Run.note)]
    tagged = _tagged(lambda value: value.icontains(text, autoescape=True))
    return or_(*inside, tagged, *_begins(text))


def _begins(text: str) -> list[ColumnElement[bool]]:
    """The ids that begin with a text, where any can: as a range, on every database alike."""
    digits = text.replace("-", "").lower()
    if not re.fullmatch("[0-9a-f]{1,32}", digits):
        return []
    low, high = (UUID(digits.ljust(32, end)) for end in "0f")
    return [Run.id.between(low, high)]


def page(
    session: Session, statement: Select[Run], sort: str, cursor: str | None, limit: int
) -> Sequence[LISTED]:
    """Runs from a place on with what they are sorted by, and one more if there is one."""
    name, falling = sort.removeprefix("-"), sort.startswith("-")
    key = KEYS[name]
    listed = statement.add_columns(key)
    if cursor:
        listed = listed.where(_after(key, falling, *_position(cursor, sort)))
    ordered = [key.desc() if falling else key, Run.id.desc() if falling else Run.id]
    return session.execute(listed.order_by(key.is_(None), *ordered).limit(limit + 1)).all()


def _after(
    key: ColumnElement[Any], falling: bool, value: Any, last: UUID
) -> ColumnElement[bool]:
    later = Run.id < last if falling else Run.id > last
    if value is None:
        return and_(key.is_(None), later)
    beyond = key < value if falling else key > value
    return or_(beyond, and_(key == value, later), key.is_(None))


def cursor(sort: str, rows: Sequence[LISTED], limit: int) -> str | None:
    """Where the list goes on after a page; None at its end."""
    if len(rows) <= limit:
        return None
    run, value = rows[limit - 1]
    plain = value.isoformat() if isinstance(value, datetime) else value
    return urlsafe_b64encode(json.dumps([sort, plain, str(run.id)]).encode()).decode()


def _position(cursor: str, sort: str) -> tuple[Any, UUID]:
    try:
        sorted_by, value, last = json.loads(urlsafe_b64decode(cursor))
        if sorted_by != sort:
            raise ValueError(sort)
        return _value(value, sort.removeprefix("-")), UUID(last)
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):
        needed = "the `next` of an earlier answer to the same `sort`"
        detail = f"`cursor` must be {needed}; got {cursor!r:.80}."
        error = FieldError(field="cursor", message=detail, needed=needed, got=brief(cursor))
        raise ProblemError(422, "Invalid input", detail, [error]) from None


def _value(value: Any, name: str) -> Any:
    """What a cursor says of a run's value, as the database has it; an error where it cannot."""
    if value is None:
        return None
    if name in MOMENTS:
        return datetime.fromisoformat(value).astimezone(UTC)
    if name in TEXTS:
        return _text(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(value)
    return _whole(value, WHOLE[name]) if name in WHOLE else _finite(value)


def _text(value: str) -> str:
    value.encode()  # Not possible with lone surrogates.
    if "\0" in value:
        raise ValueError(value)
    return value


def _whole(value: float, end: int) -> int:
    if not isinstance(value, int) or not 0 <= value < end:
        raise ValueError(value)
    return value


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise ValueError(value)
    return float(value)


def tags(session: Session) -> Sequence[Row[str, int]]:
    """All tags with the number of runs that have them, by name."""
    value = members(Run.tags).table_valued("value").c.value
    counted = select(value, func.count()).select_from(Run).join(value.table, true())
    counted = counted.where(KEPT)
    return session.execute(counted.group_by(value).order_by(value)).all()
