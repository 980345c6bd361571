"""The jobs that the queue names.

The engine is imported inside: what goes wrong with it, or with its device, is an attempt's
failure and kept on the run.
"""

import os
from functools import cache
from uuid import UUID

from server.renderings import storage as renderings
from server.services.services import Services, connect
from server.settings import Settings
from server.tables import REPLAY

from . import plugins
from .attempt import claimed

WORKER = "MICROCOSMOS_WORKER"
"""The variable in which a job's process finds the name of its worker."""


@cache
def services() -> Services:
    return connect(Settings())


def evolve(run_id: str) -> None:
    """Safe to start again: it claims the run and goes on from its last checkpoint."""
    with claimed(services(), UUID(run_id), os.environ[WORKER]) as attempt:
        if attempt:
            from .evolution import carry_out

            carry_out(attempt)


@cache
def prepared() -> None:
    """Settings of the device: once, before a process first computes."""
    from microcosmos.device import prepare

    prepare()
    plugins.load(services().settings)


def render(creature: str, kind: str = REPLAY) -> None:
    """Make and keep a rendering of a creature."""
    prepared()
    from .pictures import make

    renderings.save(services(), creature, kind, make(services(), creature, kind))
