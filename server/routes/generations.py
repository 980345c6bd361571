"""The curves of a run."""

from typing import Annotated

from fastapi import APIRouter, Query
from sqlalchemy import select

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
    """All generations, or about so many of them, evenly spaced."""
    names = list(Curves.model_fields)
    columns = [getattr(Generation, name) for name in names]
    statement = select(*columns).where(Generation.run_id == run.id)
    if points:
        statement = statement.where(Generation.generation.in_(evenly(run.generation, points)))
    rows = session.execute(statement.order_by(Generation.generation)).all()
    values = [list(column) for column in zip(*rows, strict=True)] or [[] for _ in names]
    return Curves(**dict(zip(names, values, strict=True)))
