"""FastAPI dependencies: the creature that a path names."""

from typing import Annotated

from fastapi import Depends, Path

from ..core.errors import ProblemError
from ..services.deps import SessionDep
from ..tables import Creature

Sha = Annotated[str, Path(pattern="^[0-9a-f]{64}$")]


def creature(sha: Sha, session: SessionDep) -> Creature:
    found = session.get(Creature, sha)
    if found is None:
        raise ProblemError(404, "Not found", f"No creature has the name {sha}.")
    return found


CreatureDep = Annotated[Creature, Depends(creature)]
