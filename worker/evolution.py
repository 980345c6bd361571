"""Compute a run: drive the engine's experiment from the last checkpoint."""

import time
from contextlib import AbstractContextManager, nullcontext, suppress
from functools import cache
from typing import Any

from pydantic import ValidationError

from microcosmos.build import build
from microcosmos.cluster import over
from microcosmos.device import prepare
from microcosmos.experiments import Experiment, OtherDevice, Stopped
from microcosmos.experiments.breeding import UnknownCreature
from microcosmos.experiments.evolution import Evolution
from microcosmos.plugins import Broken, Missing
from microcosmos.sinks.delivery import Sinks
from microcosmos.spec import field_path, parse
from server.attempts import choices
from server.attempts.attempt import Attempt
from server.settings import Settings

from .plugins import load
from .sinks import last_files, open_sinks


def carry_out(attempt: Attempt) -> None:
    """Compute until the run is done or has to stop."""
    prepare()
    load(attempt.services.settings)
    try:
        compute(attempt)
    except Missing as error:
        attempt.pause_until_resumed(str(error))
    except Broken as error:
        attempt.refuse(str(error))
    except ValidationError as error:  # Only a worker can validate what plug-ins declare.
        named = ((field_path(one["loc"]), one["msg"]) for one in error.errors())
        messages = ((path, text.removeprefix("Value error, ")) for path, text in named)
        attempt.refuse("; ".join(": ".join(filter(None, one)) for one in messages))


def compute(attempt: Attempt) -> None:
    data = attempt.restore()
    initial = [] if data else attempt.initial()  # A checkpoint contains its initial creatures.
    spec = parse(attempt.spec)
    experiment = build(spec, initial) if initial else build(spec)
    try:
        state = (
            experiment.restore(data, other_device=attempt.other_device)
            if data
            else experiment.init()
        )
    except OtherDevice as error:
        # The schedule did not know its kind of device; it does now.
        attempt.pause_until_resumed(str(error), device=error.recorded)
        return
    sinks = open_sinks(attempt, state.generation)
    attempt.record_device(experiment.device, sinks.names)
    with sinks:
        state = advance(attempt, experiment, state, sinks)
        done, save = experiment.done(state), cache(lambda: experiment.save(state))
        attempt.end(done, state.generation, save)
        files = last_files(experiment, state, save) if sinks.names and done else {}
        sinks.close(state.generation, files, done=done)


def advance(attempt: Attempt, experiment: Experiment, state: Any, sinks: Sinks) -> Any:
    """Return the state in which the run is done or has to stop; record all until then."""
    with on_cluster(experiment, attempt.services.settings) as computing, suppress(Stopped):
        while not (computing.done(state) or attempt.interrupted()):
            started = time.monotonic()
            before = with_choices(attempt, computing, state)
            state, report = computing.advance(before, stop=attempt.interrupted)
            attempt.record(report, time.monotonic() - started)
            sinks.report(report)
            if attempt.checkpoint_due():
                data = experiment.save(state)
                attempt.checkpoint(report.generation, data)
                sinks.checkpoint(report.generation, data)
    return state


def with_choices(attempt: Attempt, experiment: Experiment, state: Any) -> Any:
    """Return the state in which creatures count that were chosen for the next generation."""
    if not isinstance(experiment, Evolution) or experiment.plan.breeding is None:
        return state
    generation = state.generation + 1
    files = choices.begin(attempt, generation)
    try:
        return experiment.choose(state, files)
    except UnknownCreature as error:
        # The run went on, from before they entered, on another kind of device.
        choices.forget(attempt, generation, error.names)
        known = [file for file in files if file["sha256"] not in error.names]
        return experiment.choose(state, known)


def on_cluster(
    experiment: Experiment, settings: Settings
) -> AbstractContextManager[Experiment]:
    """Let the helpers of the worker's cluster, if it has one, compute a search too."""
    if not settings.cluster or not isinstance(experiment, Evolution):
        return nullcontext(experiment)
    return over(experiment, settings.cluster, settings.cluster_certificate)
