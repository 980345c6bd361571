"""The curves of a run."""

from typing import Annotated

from fastapi import APIRouter, Query
from sqlalchemy import select

from ..auth.authorize import MAY_READ, MAY_READ_SHARED
from ..services.deps import SessionDep
from ..tables import Generation
from .curves import told
from .deps import RunDep
from .overview import evenly
from .schemas import Curves, Species
from .species import history

router = APIRouter(prefix="/runs/{run_id}", tags=["runs"])


@router.get("/generations", dependencies=[MAY_READ_SHARED])
def read_generations(
    run: RunDep,
    session: SessionDep,
    points: Annotated[int | None, Query(ge=2, le=10_000)] = None,
) -> Curves:
    """All generations, or about so many of them, evenly spaced.

    What `summary` tells is thinned to the newest value since the point before.
    """
    names = [name for name in Curves.model_fields if name != "summary"]
    statement = select(*(getattr(Generation, name) for name in names)).where(
        Generation.run_id == run.id, Generation.generation <= run.generation
    )
    if points:
        statement = statement.where(Generation.generation.in_(evenly(run.generation, points)))
    rows = session.execute(statement.order_by(Generation.generation)).all()
    values = [list(column) for column in zip(*rows, strict=True)] or [[] for _ in names]
    columns = dict(zip(names, values, strict=True))
    return Curves(**columns, summary=told(session, run.id, columns["generation"]))


@router.get("/species", dependencies=[MAY_READ])
def read_species(
    run: RunDep,
    session: SessionDep,
    points: Annotated[int, Query(ge=2, le=10_000)] = 400,
) -> Species:
    """How many members each species had, in about so many generations, evenly spaced.

    There are none where the search keeps no species, or was computed before they were told.
    """
    return Species(**history(session, run.id, evenly(run.generation, points)))
