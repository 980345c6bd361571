"""The file of an archive as it was when it was shared, with its licence and whom to credit."""

import logging

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from microcosmos.archive import export

from .artifacts import Artifacts
from .models import CHECKPOINT, PUBLISHED, Artifact, Share

log = logging.getLogger(__name__)


def path(share: Share) -> str:
    return f"shares/{share.slug}.h5"


def keep(session: Session, artifacts: Artifacts, share: Share) -> None:
    """Keep a copy of the checkpoint of the generation, where there is one."""
    mine = (Artifact.run_id == share.run_id) & (Artifact.kind == CHECKPOINT)
    same = select(Artifact).where(mine, Artifact.generation == share.generation)
    checkpoint = session.scalars(same.order_by(Artifact.number.desc()).limit(1)).first()
    if checkpoint is None:
        return
    data = export.licensed(artifacts.read(checkpoint.path), share.licence, share.credit)
    stored = artifacts.write(path(share), data)
    session.add(
        Artifact(
            path=stored.path,
            kind=PUBLISHED,
            run_id=share.run_id,
            generation=share.generation,
            size=stored.size,
            sha256=stored.sha256,
        )
    )


def find(session: Session, share: Share) -> Artifact | None:
    return session.get(Artifact, path(share))


def forget(session: Session, share: Share) -> str | None:
    """The path of the file that nobody may see any more, if there was one."""
    gone = delete(Artifact).where(Artifact.path == path(share)).returning(Artifact.path)
    return session.scalars(gone).one_or_none()
