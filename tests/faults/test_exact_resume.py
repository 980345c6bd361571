"""Whatever interrupts a run, it ends with the same archive, byte for byte."""

import random
import signal

import pytest
from drive import (
    REDIS,
    interrupt,
    kill_job,
    kill_supervisor,
    pause_and_resume,
    stop_worker,
    wait_until,
)

FEW = [kill_job, pause_and_resume]
MANY = [kill_job, stop_worker, kill_job, pause_and_resume, kill_supervisor, kill_job]
LATEST = 9
"""Faults come before this generation, so that the run is not over."""


@pytest.mark.parametrize("faults", [FEW, pytest.param(MANY, marks=pytest.mark.long)])
def test_a_run_that_is_killed_stopped_and_paused_ends_with_the_same_archive(
    place, spec, undisturbed, faults
):
    moments = sorted(random.choices(range(LATEST), k=len(faults)))
    run = place.submit(spec)
    interrupt(place, run, faults, moments)
    assert place.wait(run, "finished")["attempt"] == 1 + len(faults)
    assert place.archive(run) == undisturbed.archive, f"interrupted at {moments}"
    assert place.told(run) == undisturbed.told


@pytest.mark.long
def test_a_run_goes_on_while_redis_is_killed_and_started_again(place, spec, undisturbed):
    run = place.submit(spec)
    attempt = place.reach(run, 1)
    place.signal(REDIS, signal.SIGKILL)
    assert place.wait(run, "finished")["attempt"] == attempt
    assert place.archive(run) == undisturbed.archive
    place.wait(place.submit(spec), "finished")


@pytest.mark.long
def test_a_frozen_worker_is_replaced_and_writes_nothing_when_it_wakes(place, spec, undisturbed):
    run = place.submit(spec)
    attempt = place.reach(run, 2)
    owner = place.owner(run)
    with place.frozen([owner, *owner.children(recursive=True)]):
        successor = place.reach(run, 0, after=attempt)
    assert place.wait(run, "finished")["attempt"] == successor == attempt + 1
    assert place.archive(run) == undisturbed.archive
    assert place.told(run) == undisturbed.told
    wait_until(lambda: not owner.children(), 10, "the woken job has ended")
    assert owner.is_running()


@pytest.mark.long
def test_ctrl_c_leaves_no_process_and_the_next_start_goes_on(place, spec, undisturbed):
    run = place.submit(spec)
    place.reach(run, 3)
    assert place.end(signal.SIGINT) == 0
    assert not list(place.processes())
    place.start()
    place.wait(run, "finished")
    assert place.archive(run) == undisturbed.archive
    assert place.told(run) == undisturbed.told
