"""The picture and the film of a share, which other sites show beside its link."""

import logging

from redis import RedisError
from sqlalchemy.orm import Session

from ..renderings import storage as renderings
from ..services.services import Services
from ..tables import LOOP, PREVIEW

log = logging.getLogger(__name__)


def order(services: Services, session: Session, cover: str, *, anonymous: bool = False) -> None:
    """Enqueue what is missing, the picture first; nobody waits for it."""
    try:
        for kind in (PREVIEW, LOOP):
            if renderings.find(session, cover, kind) is None:
                renderings.enqueue(services, cover, kind, anonymous=anonymous)
    except (RedisError, renderings.RenderingFailed) as error:
        log.warning("The preview of %s is left to its next visitor: %s", cover, error)
