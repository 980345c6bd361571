"""A run that comes to another kind of device waits for leave, and its archive says so."""

import json

import pytest

from microcosmos.archive import file

pytestmark = pytest.mark.long


def test_a_run_goes_on_elsewhere_only_when_somebody_says_so(installation, spec):
    place = installation()
    place.start()
    run = place.submit(spec)
    place.reach(run, 3)
    place.end()
    place.environment["XLA_FLAGS"] = "--xla_cpu_enable_fast_math=false"  # Another kind.
    place.start()
    waiting = place.wait(run, "paused")
    assert "To go on here, resume the run" in waiting["warning"]
    place.ask(run, "resume")
    place.wait(run, "finished")
    _, attributes = file.load(place.archive(run))
    first, second = json.loads(attributes["device"])
    assert first != second
    assert second.endswith("--xla_cpu_enable_fast_math=false")
