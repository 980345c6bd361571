"""The curves of a run."""

from typing import Annotated

from fastapi import APIRouter, Query
from sqlalchemy import select

from ..curves import told
from ..deps import RunDep, SessionDep
from ..models import Generation
from ..progress import evenly
from ..schemas import Curves

router = APIRouter(prefix="/runs/{run_id}/generations", tags=["runs"])


@router.get("")
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
        Generation.run_id == run.id
    )
    if points:
        statement = statement.where(Generation.generation.in_(evenly(run.generation, points)))
    rows = session.execute(statement.order_by(Generation.generation)).all()
    values = [list(column) for column in zip(*rows, strict=True)] or [[] for _ in names]
    columns = dict(zip(names, values, strict=True))
    return Curves(**columns, summary=told(session, run.id, columns["generation"]))
