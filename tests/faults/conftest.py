"""Real servers, workers, databases and queues, and what goes wrong with them."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # For `drive`, which acceptance uses too.

from drive import Installation  # noqa: E402

SHORT = {
    "MICROCOSMOS_DEMONSTRATION": "0",
    "MICROCOSMOS_CHECKPOINT_INTERVAL": "0.2",
    "MICROCOSMOS_LEASE": "3",
    "MICROCOSMOS_RECONCILE_INTERVAL": "0.5",
    "JAX_PLATFORMS": "cpu",
}
"""Settings under which what takes a minute takes a second."""


@pytest.fixture(scope="session")
def compiled(tmp_path_factory):
    """A folder for compiled programs that all installations share."""
    return tmp_path_factory.mktemp("compiled")


@pytest.fixture
def installation(tmp_path, compiled):
    """Makes installations, each in a data folder of its own; they are gone afterwards."""
    made = []

    def make(name="data", **environment):
        caches = {"JAX_COMPILATION_CACHE_DIR": str(compiled)}
        place = Installation(tmp_path / name, SHORT | caches | environment)
        made.append(place)
        return place

    yield make
    for place in made:
        place.close()


@pytest.fixture
def spec():
    """The smallest run that is still a run: 12 generations of 16 creatures."""
    return {
        "experiment": "quality-diversity",
        "seed": 7,
        "world": {"width": 32, "height": 32},
        "body": {"nodes": 12},
        "control": {"period": 30},
        "task": {"steps": 60},
        "search": {"generations": 12, "batch": 16, "block": 8},
    }
