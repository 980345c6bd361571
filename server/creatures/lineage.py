"""Who came from whom, both ways."""

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from ..tables import Creature, Parent
from .schemas import Ancestors, Children, Relative

MOST = 200
"""Relatives in one answer."""


def ancestors(session: Session, row: Creature, depth: int) -> Ancestors:
    """Parents, their parents and so on, nearest first; each once, where it is nearest."""
    known, found, nearest = {row.sha256}, [], list(row.parents)
    for distance in range(1, depth + 1):
        new = [name for name in dict.fromkeys(nearest) if name not in known]
        names = new[: MOST - len(found)]
        if not names:
            break
        kept = _relatives(session, names, distance)
        found += [kept.get(name) or _unknown(name, distance) for name in names]
        known.update(names)
        older = [parent for name in names if name in kept for parent in kept[name].parents]
        nearest = new[len(names) :] + older
    more = any(name not in known for name in nearest)
    return Ancestors(parents=row.parents, items=found, more=more)


def children(session: Session, row: Creature, limit: int) -> Children:
    """Creatures that name this one as a parent, the best first; unmeasured ones come last."""
    mine = select(Parent.child).where(Parent.parent == row.sha256).distinct().subquery()
    total = session.scalar(select(func.count()).select_from(mine)) or 0
    fitness = Creature.measured["fitness"].as_float()
    asked = (
        select(Creature.sha256)
        .join(mine, mine.c.child == Creature.sha256)
        .order_by(fitness.is_(None), fitness.desc(), Creature.sha256)
        .limit(limit)
    )
    names = list(session.scalars(asked))
    kept = _relatives(session, names, 1)
    return Children(total=total, items=[kept[name] for name in names])


def _relatives(session: Session, names: list[str], distance: int) -> dict[str, Relative]:
    columns = (
        Creature.sha256,
        Creature.parents,
        Creature.operator,
        Creature.measured,
        Creature.provenance,
        Creature.licence,
        Creature.credit,
    )
    found = session.execute(select(*columns).where(Creature.sha256.in_(names)))
    return {
        name: Relative(
            creature=name,
            distance=distance,
            kept=True,
            parents=parents,
            operator=operator,
            generation=(origin or {}).get("generation"),
            fitness=(measured or {}).get("fitness"),
            licence=licence,
            credit=credit,
        )
        for name, parents, operator, measured, origin, licence, credit in found
    }


def _unknown(name: str, distance: int) -> Relative:
    """One that never was an elite, of which nothing but its name is known."""
    return Relative(
        creature=name,
        distance=distance,
        kept=False,
        parents=[],
        operator=None,
        generation=None,
        fitness=None,
    )
