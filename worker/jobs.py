"""The jobs that the queue names."""

import time
from contextlib import suppress
from functools import cache
from uuid import UUID

from microcosmos.build import build
from microcosmos.device import device_kind, prepare
from microcosmos.experiments import Stopped
from microcosmos.render import record
from microcosmos.spec import parse

from server import replays
from server.services import Services, connect
from server.settings import Settings

from .attempt import Attempt, claimed


@cache
def services() -> Services:
    return connect(Settings())


def evolve(run_id: str) -> None:
    """Safe to start again: it claims the run and goes on from its last checkpoint."""
    prepare()
    with claimed(services(), UUID(run_id), device_kind()) as attempt:
        if attempt:
            carry_out(attempt)


def carry_out(attempt: Attempt) -> None:
    """Compute, generation by generation, until it is done or somebody wants it to stop."""
    experiment = build(parse(attempt.spec))
    data = attempt.restore()
    state = experiment.restore(data) if data else experiment.init()
    with suppress(Stopped):
        while not (experiment.done(state) or attempt.interrupted()):
            started = time.monotonic()
            state, report = experiment.advance(state, stop=attempt.interrupted)
            seconds = time.monotonic() - started
            attempt.record(report, seconds, lambda: experiment.save(state))  # noqa: B023
    done, generation = experiment.done(state), experiment.generation(state)
    attempt.end(done, generation, lambda: experiment.save(state))


def render(creature: str) -> None:
    """Make and keep the replay of a creature."""
    replays.save(services(), creature, record(replays.creature(services(), creature)))
