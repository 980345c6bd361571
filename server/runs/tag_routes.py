"""Tags that runs have."""

from fastapi import APIRouter

from ..auth.authorize import MAY_READ
from ..services.deps import SessionDep
from . import listing
from .schemas import TagRead

router = APIRouter(prefix="/tags", tags=["runs"])


@router.get("", dependencies=[MAY_READ])
def list_tags(session: SessionDep) -> list[TagRead]:
    """All of them, by name."""
    return [TagRead(tag=tag, runs=runs) for tag, runs in listing.tags(session)]
