"""Real servers, workers, databases and queues, to be disturbed."""

from contextlib import ExitStack

import pytest
from drive import QUICK, running

SHORT = QUICK | {
    "MICROCOSMOS_DEMONSTRATION": "0",
    "MICROCOSMOS_CHECKPOINT_INTERVAL": "0.2",
    "MICROCOSMOS_LEASE": "3",
    "MICROCOSMOS_RECONCILE_INTERVAL": "0.5",
}
"""Settings that shorten minutes to seconds."""

SPEC = {
    "experiment": "quality-diversity",
    "seed": 7,
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 30},
    "task": {"steps": 60},
    "search": {"generations": 12, "batch": 16, "block": 8},
}
"""The smallest run that is still a run."""


@pytest.fixture
def installation(tmp_path):
    """Starts an installation with these settings."""
    with ExitStack() as stack:
        yield lambda **more: stack.enter_context(running(tmp_path / "data", SHORT | more))


@pytest.fixture(scope="package")
def place(tmp_path_factory):
    """A running installation with two workers, which all tests may disturb."""
    with running(tmp_path_factory.mktemp("data"), SHORT | {"WORKERS": "2"}) as place:
        yield place


@pytest.fixture(scope="session")
def spec():
    return SPEC


@pytest.fixture(scope="package")
def undisturbed(place, spec):
    """The results of an undisturbed run."""
    run = place.submit(spec)
    place.wait(run, "finished", seconds=300)  # It has to compile.
    return place.results(run)
