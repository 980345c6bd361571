"""Real servers, workers, databases and queues, to be disturbed."""

from types import SimpleNamespace

import pytest
from drive import QUICK, Installation

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


def installations(tmp_path_factory):
    """Makes installations, each in its own data folder, and ends them afterwards."""
    made = []

    def make(**environment):
        made.append(Installation(tmp_path_factory.mktemp("data"), SHORT | environment))
        return made[-1]

    yield make
    for place in made:
        place.close()


installation = pytest.fixture(installations)
installation_of_file = pytest.fixture(installations, scope="module")
installation_of_folder = pytest.fixture(installations, scope="package")


@pytest.fixture(scope="package")
def place(installation_of_folder):
    """A running installation with two workers, which all tests may disturb."""
    place = installation_of_folder(WORKERS="2")
    place.start()
    return place


@pytest.fixture(scope="session")
def spec():
    return SPEC


@pytest.fixture(scope="package")
def undisturbed(place, spec):
    """The archive of an undisturbed run, and the API's account of it."""
    run = place.submit(spec)
    place.wait(run, "finished", seconds=300)  # It has to compile.
    return SimpleNamespace(archive=place.archive(run), account=place.account(run))
