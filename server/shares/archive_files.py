"""The file of an archive as it was when it was shared, with its licence and whom to credit."""

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from microcosmos.archive import export

from ..core.database import insert_missing
from ..services.services import Services
from ..storage.artifacts import Stored
from ..tables import CHECKPOINT, PUBLISHED, Artifact, Share


def path(share: Share) -> str:
    return f"shares/{share.slug}.h5"


def keep(services: Services, share: Share) -> None:
    """Keep a copy of the checkpoint of the generation, where there is one.

    It may be large: nobody who wants to write has to wait for it.
    """
    with services.sessions.read() as session:
        checkpoint = None if find(session, share) else _checkpoint(session, share)
    if checkpoint is None:
        return
    kept = Stored(checkpoint.path, checkpoint.size, checkpoint.sha256)
    whole = services.artifacts.sound(kept)
    if whole is None:
        return
    data = export.licensed(whole, share.licence, share.credit)
    stored = services.artifacts.write(path(share), data)
    row = {
        "path": stored.path,
        "kind": PUBLISHED,
        "run_id": share.run_id,
        "generation": share.generation,
        "size": stored.size,
        "sha256": stored.sha256,
    }
    with services.sessions.write.begin() as session:
        insert_missing(session, Artifact, [row])


def _checkpoint(session: Session, share: Share) -> Artifact | None:
    mine = (Artifact.run_id == share.run_id) & (Artifact.kind == CHECKPOINT)
    same = select(Artifact).where(mine, Artifact.generation == share.generation)
    return session.scalars(same.order_by(Artifact.number.desc()).limit(1)).first()


def find(session: Session, share: Share) -> Artifact | None:
    return session.get(Artifact, path(share))


def forget(session: Session, share: Share) -> str | None:
    """The path of the file that nobody may see any more, if there was one."""
    gone = delete(Artifact).where(Artifact.path == path(share)).returning(Artifact.path)
    return session.scalars(gone).one_or_none()
