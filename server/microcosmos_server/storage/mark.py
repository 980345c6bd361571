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
    if used is None and found(artifacts) is None:
        artifacts.write(MARK, str(own).encode())


def fault(sessions: Sessions, artifacts: Artifacts) -> str | None:
    """Return why this is not the installation's store; None if it is."""
    with sessions.read() as session:
        own = str(session.scalars(select(InstallationState.id)).one())
    place = "The store"  # Where it is stands on the page Health, for administrators.
    try:
        left = found(artifacts)
    except StoreUnavailable as error:
        return f"{place} cannot be read: {error}"
    if left == own:
        return None
    belongs = f"belongs to installation {left and left[:36]}: see its file"
    what = "has no file" if left is None else belongs
    setting = "the folder's mount" if artifacts.local else "AWS_ENDPOINT_URL"
    return (
        f"{place} {what} `{MARK}`. Check MICROCOSMOS_ARTIFACTS_URL and {setting}; "
        f"if this is the right store, write {own} into that file"
    )


def found(artifacts: Artifacts) -> str | None:
    """Return the id in the mark of a store; None if it has none."""
    content = artifacts.find(MARK)
    return None if content is None else content.decode(errors="replace").strip()
