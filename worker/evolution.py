"""How a run is computed: the engine's experiment, driven from its last checkpoint."""

import time
from contextlib import suppress

from microcosmos.build import build
from microcosmos.device import device_kind, prepare
from microcosmos.experiments import OtherDevice, Stopped
from microcosmos.spec import parse

from .attempt import Attempt


def carry_out(attempt: Attempt) -> None:
    """Compute, generation by generation, until it is done or somebody wants it to stop."""
    prepare()
    attempt.use(device_kind())
    data = attempt.restore()
    # A file has what its run began from.
    origin = [] if data else attempt.origin()
    spec = parse(attempt.spec)
    experiment = build(spec, origin) if origin else build(spec)
    try:
        state = (
            experiment.restore(data, other_device=attempt.other_device)
            if data
            else experiment.init()
        )
    except OtherDevice as error:
        attempt.wait_for_leave(str(error))
        return
    with suppress(Stopped):
        while not (experiment.done(state) or attempt.interrupted()):
            started = time.monotonic()
            state, report = experiment.advance(state, stop=attempt.interrupted)
            seconds = time.monotonic() - started
            attempt.record(report, seconds, lambda: experiment.save(state))  # noqa: B023
    done, generation = experiment.done(state), experiment.generation(state)
    attempt.end(done, generation, lambda: experiment.save(state))
