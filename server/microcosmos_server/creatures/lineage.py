"""Lineage: ancestors and children of a creature."""

from typing import Any

from pydantic import Field
from sqlalchemy import func, select
from sqlalchemy.orm import Session, defer

from ..core.schemas import Wire
from ..tables import Creature, Parent

MAX_RELATIVES = 200
UNKNOWN: Any = {
    "stored": False,
    "parents": [],
    "operator": None,
    "generation": None,
    "fitness": None,
}


class Relative(Wire):
    """An ancestor or a child of a creature."""

    creature: str
    distance: int
    """Generations between the two."""
    stored: bool
    """False if it never was an elite; then only its name is known."""
    parents: list[str]
    operator: str | None
    generation: int | None
    fitness: float | None
    licence: str | None = None
    credit: list[str] = Field(default=[])
    """People whom its file asks to name; its descendants' files name them too."""


class Ancestors(Wire):
    parents: list[str]
    """Parents of the creature itself."""
    items: list[Relative]
    """Nearest first."""
    more: bool
    """There are others, older than requested or too many for one answer."""


class Children(Wire):
    total: int
    items: list[Relative]
    """Best first; those that were never measured come last."""


def ancestors(session: Session, row: Creature, depth: int) -> Ancestors:
    """Return parents, their parents and so on, nearest first; each once, at its nearest."""
    known, found, nearest = {row.sha256}, [], list(row.parents)
    for distance in range(1, depth + 1):
        new = [name for name in dict.fromkeys(nearest) if name not in known]
        names = new[: MAX_RELATIVES - len(found)]
        if not names:
            break
        stored = _relatives(session, names, distance)
        found += [
            stored.get(name) or Relative(creature=name, distance=distance, **UNKNOWN)
            for name in names
        ]
        known.update(names)
        older = [parent for name in names if name in stored for parent in stored[name].parents]
        nearest = new[len(names) :] + older
    more = any(name not in known for name in nearest)
    return Ancestors(parents=row.parents, items=found, more=more)


def children(session: Session, row: Creature, limit: int) -> Children:
    """Return creatures that name this one as a parent, best first, unmeasured ones last."""
    mine = select(Parent.child).where(Parent.parent == row.sha256).distinct().subquery()
    total = session.scalar(select(func.count()).select_from(mine)) or 0
    fitness = Creature.measured["fitness"].as_float()
    ordered = (
        select(Creature.sha256)
        .join(mine, mine.c.child == Creature.sha256)
        .order_by(fitness.is_(None), fitness.desc(), Creature.sha256)
        .limit(limit)
    )
    names = list(session.scalars(ordered))
    stored = _relatives(session, names, 1)
    return Children(total=total, items=[stored[name] for name in names])


def _relatives(session: Session, names: list[str], distance: int) -> dict[str, Relative]:
    some = select(Creature).where(Creature.sha256.in_(names))
    rows = session.scalars(some.options(defer(Creature.identity)))
    return {
        row.sha256: Relative(
            creature=row.sha256,
            distance=distance,
            stored=True,
            parents=row.parents,
            operator=row.operator,
            generation=(row.provenance or {}).get("generation"),
            fitness=(row.measured or {}).get("fitness"),
            licence=row.licence,
            credit=row.credit,
        )
        for row in rows
    }
