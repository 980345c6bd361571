"""Births: creatures with their parents and the runs that they entered, and trees of them."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from uuid import UUID

from sqlalchemy import ColumnElement, Select, func, or_, select, true
from sqlalchemy.orm import Session, aliased

from microcosmos.archive.phylogeny import Birth, Phylogeny, births_of, entries, phylogeny

from ..archives.elites import recorded_in
from ..core.errors import Invalid
from ..creatures import lineage
from ..creatures.storage import MAX_DEPTH
from ..tables import Creature, Elite, InitialCreature, Parent, Run

NAMES_PER_QUERY = 500
# Creatures of one tree: about 30 MB of columns.
MAX_CREATURES = 400_000

Links = Mapping[str, Sequence[str]]
"""Parents by the name of their child, in the order in which it names them."""


def entered(session: Session, run: Run, generation: int) -> list[Birth]:
    """Return all creatures that entered the archive of a run up to a generation."""
    mine = recorded_in(run) & (Elite.generation <= generation)
    counted = select(func.count()).select_from(Elite).where(mine)
    refuse_large(session.execute(counted).scalar_one())
    columns = (Elite.cell, Elite.generation, Elite.creature, Elite.fitness, Creature.operator)
    rows = session.execute(
        select(*columns)
        .outerjoin(Creature, Creature.sha256 == Elite.creature)
        .where(mine)
        .order_by(Elite.cell, Elite.generation)
    ).all()
    names = select(Elite.creature).where(mine, Elite.creature.is_not(None))
    links = select(Parent.child, Parent.parent).where(Parent.child.in_(names))
    found = entries(str(run.id), rows)
    return list(births_of(found, _linked(session, links)))


def ancestors_of_run(session: Session, run: Run, generation: int) -> list[Birth]:
    """Return the creatures from which a run starts, and their ancestors, as of a generation of
    this run; other runs count as they are now."""
    mine = InitialCreature.run_id == run.id
    initial = session.scalars(select(InitialCreature.creature).where(mine)).all()
    # In the order of their names: the births are part of entity tags.
    return _read(session, sorted(_closure(session, initial, _parents)), (run.id, generation))


def initial(session: Session, runs: Iterable[UUID]) -> list[tuple[str, str]]:
    """Return runs with each of the creatures from which they start."""
    columns = select(InitialCreature.run_id, InitialCreature.creature)
    rows = session.execute(columns.where(InitialCreature.run_id.in_(runs)))
    return [(str(run), creature) for run, creature in rows]


def relatives(session: Session, sha: str) -> list[Birth]:
    """Return a creature, all its ancestors and all its descendants, of any runs."""
    above = _closure(session, [sha], _parents)
    below = _closure(session, [sha], _children)
    return _read(session, dict.fromkeys((*above, *below)))


def shared(session: Session, row: Creature) -> list[Birth]:
    """Return a creature and the ancestors that a share shows, without their runs."""
    above = lineage.ancestors(session, row, MAX_DEPTH).items
    stored = [one.creature for one in above if one.stored]
    found = _read(session, [row.sha256, *stored])
    return [birth._replace(run=None, lost={}) for birth in found]


def refuse_large(count: int) -> None:
    """Raise `DomainError` for more creatures than one tree holds."""
    if count > MAX_CREATURES:
        detail = (
            f"This tree has {count:,} creatures, more than the {MAX_CREATURES:,} that one "
            "answer holds. The archive file of a run has its whole lineage."
        )
        raise Invalid(detail, title="Tree too large")


def _parents(names: Sequence[str]) -> Select[str]:
    return select(Parent.parent).where(Parent.child.in_(names))


def _children(names: Sequence[str]) -> Select[str]:
    return select(Parent.child).where(Parent.parent.in_(names))


def _closure(
    session: Session, names: Iterable[str], step: Callable[[Sequence[str]], Select[str]]
) -> dict[str, None]:
    """Return names and all names that steps from them reach."""
    found, nearest = dict.fromkeys(names), list(names)
    while nearest:
        next_names = (name for some in _parts(nearest) for name in session.scalars(step(some)))
        nearest = [name for name in dict.fromkeys(next_names) if name not in found]
        found |= dict.fromkeys(nearest)
        refuse_large(len(found))
    return found


def _parts(names: Iterable[str]) -> Iterator[list[str]]:
    listed = list(names)
    for first in range(0, len(listed), NAMES_PER_QUERY):
        yield listed[first : first + NAMES_PER_QUERY]


_Later = aliased(Elite)


def _read(
    session: Session, names: Iterable[str], until: tuple[UUID, int] | None = None
) -> list[Birth]:
    """Return births in the first run that each creature entered; `until` is a run and its last
    generation that counts.

    Creatures that entered no archive, such as imported ones, have the generation of their file.
    """

    def counts(entry: type[Elite]) -> ColumnElement[bool]:
        if until is None:
            return true()
        run, generation = until
        return or_(entry.run_id != run, entry.generation <= generation)

    same_cell = (_Later.run_id == Elite.run_id) & (_Later.cell == Elite.cell)
    later = same_cell & (_Later.generation > Elite.generation) & counts(_Later)
    # The generation in which an elite lost its cell; null if it still holds the cell.
    lost = select(func.min(_Later.generation)).where(later).scalar_subquery()
    recorded = Creature.provenance["generation"].as_integer()
    measured = Creature.measured["fitness"].as_float()
    columns = (
        Creature.sha256,
        Elite.run_id,
        func.coalesce(Elite.generation, recorded),
        lost,
        Creature.operator,
        func.coalesce(Elite.fitness, measured),
    )
    found: list[Birth] = []
    for some in _parts(names):
        rows = (
            select(*columns)
            .outerjoin(Elite, (Elite.creature == Creature.sha256) & counts(Elite))
            .outerjoin(Run, Run.id == Elite.run_id)
            .where(Creature.sha256.in_(some))
            .order_by(Run.created_at, Run.id, Elite.generation, Creature.sha256)
        )
        links = select(Parent.child, Parent.parent).where(Parent.child.in_(some))
        named = ((one[0], one[1] and str(one[1]), *one[2:]) for one in session.execute(rows))
        found += births_of(named, _linked(session, links))
    return found


def _linked(session: Session, links: Select[str, str]) -> Links:
    found: dict[str, list[str]] = {}
    for child, parent in session.execute(links.order_by(Parent.child, Parent.position)):
        found.setdefault(child, []).append(parent)
    return found


def arranged(session: Session, found: list[Birth]) -> Phylogeny:
    """Arrange births, with their runs in the order of creation."""
    named = {UUID(one.run) for one in found if one.run}
    ordered = select(Run.id).where(Run.id.in_(named)).order_by(Run.created_at, Run.id)
    runs = [str(run) for run in session.scalars(ordered)]
    return phylogeny(found, runs, initial(session, named))


def of_run(
    session: Session, run: Run, ancestors: Sequence[Birth], generation: int
) -> Phylogeny:
    """Return all creatures that entered a run's archive up to a generation, below its
    ancestors."""
    known = {one.creature for one in ancestors}
    found = entered(session, run, generation)
    alone = [one for one in found if one.creature not in known]
    return arranged(session, [*ancestors, *alone])
