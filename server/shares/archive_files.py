"""The archive file of a share: a copy of a checkpoint with its licence and credit."""

from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive import export

from ..core.database import insert_missing
from ..services.services import Services
from ..tables import CHECKPOINT, PUBLISHED, Artifact, Share


def path(share: Share) -> str:
    return f"shares/{share.slug}.h5"


def copy_checkpoint(services: Services, share: Share) -> None:
    """Copy the checkpoint of the shared generation, if there is one.

    The file may be large, so it is written outside any transaction.
    """
    with services.sessions.read() as session:
        mine = (Artifact.run_id == share.run_id) & (Artifact.kind == CHECKPOINT)
        same = select(Artifact).where(mine, Artifact.generation == share.generation)
        checkpoint = session.scalars(same.order_by(Artifact.number.desc()).limit(1)).first()
        copied = find(session, share) is not None
    if copied or checkpoint is None:
        return
    data = services.artifacts.read_verified(checkpoint.path, checkpoint.sha256)
    if data is None:
        return
    licensed = export.licensed(data, share.licence, share.credit)
    stored = services.artifacts.write(path(share), licensed)
    of_run = {"run_id": share.run_id, "generation": share.generation}
    with services.sessions.write.begin() as session:
        insert_missing(session, Artifact, [{**vars(stored), "kind": PUBLISHED, **of_run}])


def find(session: Session, share: Share) -> Artifact | None:
    return session.get(Artifact, path(share))
