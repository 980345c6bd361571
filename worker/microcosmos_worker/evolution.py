"""Compute a run: drive the engine's experiment from the last checkpoint."""

import json
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext, suppress
from functools import cache
from typing import Any

from pydantic import ValidationError

from microcosmos.archive import export
from microcosmos.build import build
from microcosmos.build.parts import terms_of
from microcosmos.cluster import over
from microcosmos.device import prepare
from microcosmos.experiments import Experiment, OtherDevice, OtherSpec, Stopped
from microcosmos.experiments.evolution import Evolution
from microcosmos.plugins import Broken, Missing
from microcosmos.search.parts.breeding import UnknownCreature
from microcosmos.sinks.address import Record, parse_all
from microcosmos.sinks.delivery import Sinks
from microcosmos.spec import invalid_fields, parse
from microcosmos_server.attempts.attempt import Attempt, begin_choices, forget_choices
from microcosmos_server.settings import Settings

from .plugins import have_changed, load


def carry_out(attempt: Attempt) -> None:
    """Compute until the run is done or has to stop."""
    prepare()
    load(attempt.services.settings)
    try:
        compute(attempt)
    except Missing as error:
        # Edited since the worker listed it: the worker lists it anew before it takes a run.
        if have_changed(attempt.services.settings, attempt.listed_plugins()):
            attempt.requeue()
        else:
            attempt.pause_until_resumed(str(error))
    except Broken as error:
        attempt.refuse(str(error))
    except ValidationError as error:  # Only a worker can validate what plug-ins declare.
        attempt.refuse("; ".join(map(str, invalid_fields(error.errors()))))


def compute(attempt: Attempt) -> None:
    data = attempt.restore()
    initial = [] if data else attempt.initial()  # A checkpoint contains its initial creatures.
    spec = parse(attempt.spec)
    experiment = build(spec, initial) if initial else build(spec)
    attempt.terms = terms_of(spec, initial, data)
    try:
        state = (
            experiment.restore(data, other_device=attempt.other_device)
            if data
            else experiment.init()
        )
    except OtherDevice as error:
        # The schedule did not know the recorded kind of device; now `device` has it.
        attempt.pause_until_resumed(str(error), device=error.recorded)
        return
    except OtherSpec as error:  # As of another version of the program.
        attempt.pause_until_resumed(f"It cannot go on from its checkpoint: {error}")
        return
    if isinstance(experiment, Evolution):
        attempt.segments.growing = experiment.growing
        if data:
            attempt.take_back(state.evaluations)
    sinks = open_sinks(attempt, state.generation)
    attempt.record_device(experiment.device, sinks.names)
    with sinks:
        state = advance(attempt, experiment, state, sinks)
        done, save = experiment.done(state), cache(lambda: saved(attempt, experiment, state))
        attempt.end(done, state.generation, save)
        files = last_files(attempt, experiment, state, save) if sinks.names and done else {}
        sinks.close(state.generation, files, done=done)


def advance(attempt: Attempt, experiment: Experiment, state: Any, sinks: Sinks) -> Any:
    """Compute and record until the run is done or has to stop; return the last state."""
    with on_cluster(experiment, attempt.services.settings) as computing, suppress(Stopped):
        while not (computing.done(state) or attempt.interrupted()):
            started = time.monotonic()
            before = with_choices(attempt, computing, state)
            state, report = computing.advance(before, stop=attempt.interrupted)
            attempt.record(report, time.monotonic() - started)
            sinks.report(report)
            if attempt.checkpoint_due():
                data = saved(attempt, experiment, state)
                attempt.checkpoint(report.generation, data)
                sinks.checkpoint(report.generation, data)
    return state


def saved(attempt: Attempt, experiment: Experiment, state: Any) -> bytes:
    """Return the file of a run, with its licence and credit."""
    data = experiment.save(state)
    return export.licensed(data, **attempt.terms) if attempt.terms else data


def with_choices(attempt: Attempt, experiment: Experiment, state: Any) -> Any:
    """Return the state with the creatures that people chose for the next generation."""
    if not isinstance(experiment, Evolution) or experiment.plan.part("breeding") is None:
        return state
    generation = state.generation + 1
    files = begin_choices(attempt, generation)
    try:
        return experiment.receive(state, "breeding", files)
    except UnknownCreature as error:
        # Another kind of device continued the run from before these creatures entered.
        forget_choices(attempt, generation, error.names)
        known = [file for file in files if file["sha256"] not in error.names]
        return experiment.receive(state, "breeding", known)


def on_cluster(
    experiment: Experiment, settings: Settings
) -> AbstractContextManager[Experiment]:
    """Share a search with the helpers of the worker's cluster, if it has one."""
    if not settings.cluster or not isinstance(experiment, Evolution):
        return nullcontext(experiment)
    return over(experiment, settings.cluster, settings.cluster_certificate)


def open_sinks(attempt: Attempt, generation: int) -> Sinks:
    """Return the sinks that the settings name; a resumed run continues its record there."""
    name = f"{attempt.spec['experiment']}-{attempt.run_id}"
    record = Record(name, name, attempt.spec, generation)
    return Sinks(parse_all(attempt.services.settings.sinks.split(",")), record)


def last_files(
    attempt: Attempt, experiment: Experiment, state: Any, save: Callable[[], bytes]
) -> dict[str, bytes]:
    """Return the files of a run that is done, by name."""
    files, best = {"run.h5": save()}, experiment.best(state)
    if best is not None:
        files["best.json"] = json.dumps(best | attempt.terms, indent=1).encode()
    return files
