"""Workers with plug-ins, and a spec that needs them."""

import pytest

from microcosmos_server.workers import registry


@pytest.fixture
def offer(services):
    """Reports a live worker that offers plug-ins."""

    def offer(name="worker", plugins=(), **more):
        found = [dict(one) for one in plugins]
        worker = (services.sessions, name, "some device", 1 << 40, "idle")
        registry.report(*worker, plugins=found, **more)

    return offer


@pytest.fixture
def mine(spec):
    """A spec with a fitness, a descriptor and a body from plug-ins."""
    axes = [{"name": "mine.sway", "bins": 4}, {"name": "displacement", "bins": 4}]
    return {
        **spec,
        "world": {"width": 64, "height": 64},
        "body": {"builder": "mine.cross", "plugin": {"settings": {"strictness": 2}}},
        "task": {"fitness": "mine.straight", "steps": 40},
        "archive": {"descriptors": axes},
    }
