"""Whatever interrupts a run, it ends with the same archive, byte for byte."""

import random
import signal

import pytest
from drive import (
    interrupt,
    kill_job,
    kill_supervisor,
    pause_and_resume,
    stop_worker,
)

FAULTS = [kill_job, stop_worker, kill_job, pause_and_resume, kill_supervisor, kill_job]

LATEST = 9
"""Before this generation, so that the run is not over when the fault comes."""


@pytest.fixture
def undisturbed(installation, spec):
    """An installation with a finished run: its archive, and what the API tells about it."""
    place = installation()
    place.start()
    run = place.submit(spec)
    place.wait(run, "finished")
    return place, place.archive(run), place.told(run)


def test_a_run_that_is_killed_stopped_and_paused_ends_with_the_same_archive(undisturbed, spec):
    place, archive, told = undisturbed
    moments = sorted(random.choices(range(LATEST), k=len(FAULTS)))
    run = place.submit(spec)
    interrupt(place, run, FAULTS, moments)
    end = place.wait(run, "finished")
    assert end["attempt"] == 1 + len(FAULTS)
    assert place.archive(run) == archive, f"interrupted at {moments}"
    assert place.told(run) == told


def test_interrupting_everything_leaves_no_process_and_loses_nothing(undisturbed, spec):
    place, archive, told = undisturbed
    run = place.submit(spec)
    place.reach(run, 3)
    assert place.end(signal.SIGINT) == 0
    assert not list(place.processes())
    place.start()
    place.wait(run, "finished")
    assert place.archive(run) == archive
    assert place.told(run) == told
