"""RQ jobs: `render` and `first_creature`. The first job imports the engine."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from rq import get_current_job

from microcosmos.plugins import Broken, Missing
from microcosmos.spec.creature import CreatureError
from microcosmos_server.core.errors import first_line
from microcosmos_server.queue.jobs import REASON
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.services.services import Services, connect
from microcosmos_server.settings import Settings
from microcosmos_server.tables import REPLAY

from . import plugins


@cache
def services() -> Services:
    return connect(Settings())


_loaded: tuple[str | None, ...] | None = None
"""Digests of the files from which this process has loaded plug-ins."""


def prepare_job() -> None:
    """Prepare the device and load plug-ins, again when a file has changed.

    A renderer lives for weeks, and gets creatures of each version.
    """
    global _loaded
    if (now := plugins.digests(services().settings)) != _loaded:
        if _loaded is None:
            from microcosmos.device import prepare

            prepare()
        plugins.load(services().settings)
        _loaded = now


@contextmanager
def noting_failure() -> Iterator[None]:
    """Note on the job why it failed: RQ itself keeps the text of the traceback alone."""
    try:
        yield
    except Exception as error:
        own = isinstance(error, CreatureError | Missing | Broken)
        if job := get_current_job():
            job.meta[REASON] = str(error).partition("\n")[0] if own else first_line(error)
            job.save_meta()
        raise


@noting_failure()
def render(creature: str, kind: str = REPLAY) -> None:
    prepare_job()
    from .renderings import make

    renderings.save(services(), creature, kind, make(services(), creature, kind))


@noting_failure()
def first_creature(name: str, spec: dict[str, Any], number: int) -> None:
    """Keep the inputs of the evaluation of a creature of a spec's first generation."""
    prepare_job()
    from .renderings import first

    services().jobs.keep_first(name, first(spec, number))
