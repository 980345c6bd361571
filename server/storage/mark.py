"""The mark of an installation in its store.

A worker whose settings or mount lead to another store must take no run: it would miss all
checkpoints there, and write new ones where nobody looks.
"""

from sqlalchemy import select

from ..core.database import Sessions
from ..core.errors import StoreUnavailable
from ..tables import Artifact, InstallationState
from .artifacts import Artifacts

MARK = "installation"
"""Name of the file in the store; it contains the installation's id."""


def leave(sessions: Sessions, artifacts: Artifacts) -> None:
    """Mark a store in which nothing is recorded yet; the server does it when it starts."""
    with sessions.read() as session:
        own = session.scalars(select(InstallationState.id)).one()
        used = session.scalars(select(Artifact.path).limit(1)).one_or_none()
    if used is None and _found(artifacts) is None:
        artifacts.write(MARK, str(own).encode())


def fault(sessions: Sessions, artifacts: Artifacts) -> str | None:
    """Return why this is not the installation's store; None if it is."""
    with sessions.read() as session:
        own = str(session.scalars(select(InstallationState.id)).one())
    place = f"The store {artifacts.location}"
    try:
        found = _found(artifacts)
    except StoreUnavailable as error:
        return f"{place} cannot be read: {error}"
    if found == own:
        return None
    what = (
        "has no file"
        if found is None
        else f"belongs to installation {found[:36]}: see its file"
    )
    return (
        f"{place} {what} `{MARK}`. Check MICROCOSMOS_ARTIFACTS_URL and {_beside(artifacts)}; "
        f"if this is the right store, write {own} into that file"
    )


def _beside(artifacts: Artifacts) -> str:
    return "the folder's mount" if artifacts.local else "AWS_ENDPOINT_URL"


def _found(artifacts: Artifacts) -> str | None:
    content = artifacts.find(MARK)
    return None if content is None else content.decode(errors="replace").strip()
