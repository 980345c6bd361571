"""The phylogeny of a run with its ancestors in earlier runs."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive.phylogeny import Birth, Phylogeny, phylogeny

from ..tables import Run
from . import births


def arranged(session: Session, found: list[Birth]) -> Phylogeny:
    """Arrange births, with their runs in the order of creation."""
    named = {UUID(one.run) for one in found if one.run}
    ordered = select(Run.id).where(Run.id.in_(named)).order_by(Run.created_at, Run.id)
    runs = [str(run) for run in session.scalars(ordered)]
    return phylogeny(found, runs, births.initial(session, named))


def of_run(session: Session, run: Run, ancestors: Sequence[Birth]) -> Phylogeny:
    """Return all creatures that ever entered a run's archive, below its ancestors."""
    known = {one.creature for one in ancestors}
    alone = [one for one in births.entered(session, run) if one.creature not in known]
    return arranged(session, [*ancestors, *alone])
