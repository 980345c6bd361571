"""Lists of runs: filters, orders and tags."""

import re
from collections.abc import Sequence
from typing import Annotated, Any, Literal
from uuid import UUID

from pydantic import Field
from sqlalchemy import ColumnElement, Row, Select, func, or_, select, true
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.orm import Session
from sqlalchemy.sql.functions import GenericFunction

from ..core.paging import COUNT, MOMENT, NUMBER, TEXT, Order
from ..tables import PROGRESS, STATUS_PLACE, STATUSES, Run
from .lifecycle import NOT_IN_BIN

Sort = Literal[
    "created", "-created", "started", "-started", "finished", "-finished",
    "name", "-name", "experiment", "-experiment", "status", "-status",
    "progress", "-progress", "evaluations", "-evaluations",
    "qd_score", "-qd_score", "coverage", "-coverage", "best", "-best",
]  # fmt: skip

KEYS: dict[str, tuple[ColumnElement[Any], Any]] = {
    "created": (Run.created_at.expression, MOMENT),
    "started": (Run.started_at.expression, MOMENT),
    "finished": (Run.finished_at.expression, MOMENT),
    "name": (func.lower(Run.name), TEXT),
    "experiment": (Run.experiment.expression, TEXT),
    "status": (STATUS_PLACE, Annotated[int, Field(ge=0, lt=len(STATUSES))]),
    "progress": (PROGRESS, NUMBER),
    "evaluations": (Run.evaluations.expression, COUNT),
    "qd_score": (Run.qd_score.expression, NUMBER),
    "coverage": (Run.coverage.expression, NUMBER),
    "best": (Run.best.expression, NUMBER),
}


def order(sort: str) -> Order:
    return Order(sort, *KEYS[sort.removeprefix("-")], Run.id, UUID)


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
    statuses: Sequence[str],
    experiments: Sequence[str],
    tag: str | None,
    text: str | None,
    sweep: UUID | Literal["none"] | None = None,
    deleted: bool = False,
) -> Select[Run]:
    """Select runs by any of the states and experiments, a tag, a text and a sweep.

    Select either runs in the bin, or all others.
    """
    statement = select(Run).where(~NOT_IN_BIN if deleted else NOT_IN_BIN)
    if statuses:
        statement = statement.where(Run.status.in_(statuses))
    if experiments:
        statement = statement.where(Run.experiment.in_(experiments))
    if tag is not None:
        statement = statement.where(_tagged(lambda value: value == tag))
    if sweep is not None:
        statement = statement.where(Run.sweep == (None if sweep == "none" else sweep))
    wanted = (text or "").strip()
    return statement.where(_contains(wanted)) if wanted else statement


def _tagged(condition: Any) -> ColumnElement[bool]:
    value = members(Run.tags).table_valued("value")
    return select(value.c.value).where(condition(value.c.value)).exists()


def _contains(text: str) -> ColumnElement[bool]:
    """Wildcards in the text are ordinary characters."""
    inside = [column.icontains(text, autoescape=True) for column in (Run.name, Run.note)]
    tagged = _tagged(lambda value: value.icontains(text, autoescape=True))
    return or_(*inside, tagged, *_id_starts_with(text))


def _id_starts_with(text: str) -> list[ColumnElement[bool]]:
    """Compare ids with a range, which works on every database."""
    digits = text.replace("-", "").lower()
    if not re.fullmatch("[0-9a-f]{1,32}", digits):
        return []
    low, high = (UUID(digits.ljust(32, end)) for end in "0f")
    return [Run.id.between(low, high)]


def tags(session: Session) -> Sequence[Row[str, int]]:
    """Return all tags and their numbers of runs, by name."""
    value = members(Run.tags).table_valued("value").c.value
    counted = select(value, func.count()).select_from(Run).join(value.table, true())
    counted = counted.where(NOT_IN_BIN)
    return session.execute(counted.group_by(value).order_by(value)).all()
