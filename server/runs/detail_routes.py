"""Routes of a run's curves, species, log and target pictures, and of all tags."""

from typing import Annotated

from fastapi import APIRouter, Query
from sqlalchemy import select

from microcosmos.spec import Folding, parse, targets

from ..auth.authorize import MAY_READ, MAY_READ_SHARED
from ..core.errors import ProblemError
from ..core.schemas import MAX_INTEGER
from ..services.services import SessionDep
from ..specs.schemas import pictures
from ..tables import Generation
from . import curves, listing, log
from .curves import thinned
from .deps import RunDep
from .schemas import Curves, Log, LogEntryRead, Species, TagRead, Target

router = APIRouter()


@router.get("/runs/{run_id}/generations", tags=["runs"], dependencies=[MAY_READ_SHARED])
def read_generations(
    run: RunDep,
    session: SessionDep,
    points: Annotated[int | None, Query(ge=2, le=10_000)] = None,
) -> Curves:
    """Return all generations, or about `points` of them, evenly spaced.

    `summary` has the newest values since the previous point.
    """
    names = [name for name in Curves.model_fields if name != "summary"]
    statement = select(*(getattr(Generation, name) for name in names)).where(
        Generation.run_id == run.id, Generation.generation <= run.generation
    )
    if points:
        statement = statement.where(Generation.generation.in_(thinned(run.generation, points)))
    rows = session.execute(statement.order_by(Generation.generation)).all()
    values = [list(column) for column in zip(*rows, strict=True)] or [[] for _ in names]
    columns = dict(zip(names, values, strict=True))
    return Curves(**columns, summary=curves.summaries(session, run.id, columns["generation"]))


@router.get("/runs/{run_id}/species", tags=["runs"], dependencies=[MAY_READ])
def read_species(
    run: RunDep,
    session: SessionDep,
    points: Annotated[int, Query(ge=2, le=10_000)] = 400,
) -> Species:
    """Return the sizes of the species in about `points` generations, evenly spaced.

    The columns are empty if the search has no species.
    """
    return Species(**curves.species(session, run.id, thinned(run.generation, points)))


@router.get("/runs/{run_id}/log", tags=["runs"], dependencies=[MAY_READ])
def read_log(
    run: RunDep,
    session: SessionDep,
    after: Annotated[int | None, Query(ge=0, le=MAX_INTEGER)] = None,
    limit: Annotated[int, Query(ge=1, le=1000)] = 500,
) -> Log:
    """Return the newest entries, oldest first; or those that follow the entry `after`.

    An attempt keeps the first and the last entry about checkpoints.
    """
    found = log.read(session, run.id, after, limit)
    return Log(entries=[LogEntryRead.model_validate(entry) for entry in found])


@router.get("/runs/{run_id}/targets", tags=["results"], dependencies=[MAY_READ])
def read_targets(run: RunDep) -> list[Target]:
    """Return the pictures in the order of the spec, at most 256 pixels along a side."""
    if run.experiment != "folding":
        raise ProblemError(404, "No pictures", f"A run of `{run.experiment}` has no pictures.")
    spec = parse(run.spec)
    assert isinstance(spec, Folding)
    longest = min(spec.size, targets.MAX_PIXELS)
    fitted = [(one.name, targets.fitted(one.ink, longest)) for one in spec.targets]
    return [Target(**dict(one), size=spec.size) for one in pictures(fitted)]


@router.get("/tags", tags=["runs"], dependencies=[MAY_READ])
def list_tags(session: SessionDep) -> list[TagRead]:
    """Return all tags by name."""
    return [TagRead(tag=tag, runs=runs) for tag, runs in listing.tags(session)]
