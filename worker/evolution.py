"""How a run is computed: the engine's experiment, driven from its last checkpoint."""

import time
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from pydantic import ValidationError

from microcosmos.build import build
from microcosmos.device import device_kind, prepare
from microcosmos.experiments import OtherDevice, Stopped
from microcosmos.plugins import Broken, Missing
from microcosmos.spec import field_path, parse

from .attempt import Attempt
from .plugins import load


def carry_out(attempt: Attempt) -> None:
    """Compute, generation by generation, until it is done or somebody wants it to stop."""
    prepare()
    load(attempt.settings)
    attempt.use(device_kind())
    try:
        compute(attempt)
    except Missing as error:
        attempt.set_aside(str(error))
    except Broken as error:
        attempt.refuse(str(error))
    except ValidationError as error:  # What a server could not see: it has no modules.
        attempt.refuse("; ".join(map(_said, error.errors())))


def _said(error: Mapping[str, Any]) -> str:
    """The field and what is wrong with it."""
    words = str(error["msg"]).removeprefix("Value error, ")
    return ": ".join(filter(None, (field_path(error["loc"]), words)))


def compute(attempt: Attempt) -> None:
    """Go on from the last checkpoint to the end, or to where it is to stop."""
    data = attempt.restore()
    # A file has what its run began from.
    initial = [] if data else attempt.initial()
    spec = parse(attempt.spec)
    experiment = build(spec, initial) if initial else build(spec)
    try:
        state = (
            experiment.restore(data, other_device=attempt.other_device)
            if data
            else experiment.init()
        )
    except OtherDevice as error:
        attempt.wait_for_override(str(error))
        return
    with suppress(Stopped):
        while not (experiment.done(state) or attempt.interrupted()):
            started = time.monotonic()
            state, report = experiment.advance(state, stop=attempt.interrupted)
            seconds = time.monotonic() - started
            attempt.record(report, seconds, lambda: experiment.save(state))  # noqa: B023
    done, generation = experiment.done(state), experiment.generation(state)
    attempt.end(done, generation, lambda: experiment.save(state))
