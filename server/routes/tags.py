"""Tags that runs have."""

from fastapi import APIRouter

from .. import listing
from ..deps import SessionDep
from ..schemas import TagRead

router = APIRouter(prefix="/tags", tags=["runs"])


@router.get("")
def list_tags(session: SessionDep) -> list[TagRead]:
    """All of them, by name."""
    return [TagRead(tag=tag, runs=runs) for tag, runs in listing.tags(session)]
