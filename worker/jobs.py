"""RQ jobs: `render`. The first job imports the engine."""

from functools import cache

from server.renderings import storage as renderings
from server.services.services import Services, connect
from server.settings import Settings
from server.tables import REPLAY

from . import plugins


@cache
def services() -> Services:
    return connect(Settings())


@cache
def prepare_once() -> None:
    """Prepare the device and load plug-ins, at the first call in a process."""
    from microcosmos.device import prepare

    prepare()
    plugins.load(services().settings)


def render(creature: str, kind: str = REPLAY) -> None:
    prepare_once()
    from .renderings import make

    renderings.save(services(), creature, kind, make(services(), creature, kind))
