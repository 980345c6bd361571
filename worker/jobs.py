"""RQ jobs: `render` and `first_creature`. The first job imports the engine."""

from functools import cache
from typing import Any

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


def first_creature(name: str, spec: dict[str, Any], number: int) -> None:
    """Keep the inputs of the evaluation of a creature of a spec's first generation."""
    prepare_once()
    from .renderings import first

    services().jobs.keep_first(name, first(spec, number))
