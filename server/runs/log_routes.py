"""What happened to a run."""

from typing import Annotated

from fastapi import APIRouter, Query

from ..auth.authorize import MAY_READ
from ..core.schemas import MOST_ROWS
from ..services.deps import SessionDep
from . import log
from .deps import RunDep
from .schemas import Log, LogEntryRead

router = APIRouter(prefix="/runs/{run_id}/log", tags=["runs"])


@router.get("", dependencies=[MAY_READ])
def read_log(
    run: RunDep,
    session: SessionDep,
    after: Annotated[int | None, Query(ge=0, le=MOST_ROWS)] = None,
    limit: Annotated[int, Query(ge=1, le=1000)] = 500,
) -> Log:
    """The newest entries, the oldest of them first; `after` the id of one, those that follow.

    Of the checkpoints of an attempt only the first and the last are told.
    """
    found = log.read(session, run.id, after, limit)
    return Log(entries=[LogEntryRead.model_validate(entry) for entry in found])
