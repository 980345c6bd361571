"""A worker takes runs only after its self-test, which it believes until something changes."""

import time

import pytest

from worker import process_setup, readiness
from worker.device import Device
from worker.readiness import Problem, Readiness


@pytest.mark.long
def test_a_host_that_fails_its_self_test_blames_no_run_and_takes_none(
    run_id, row, busy, next_run, monkeypatch
):
    busy.environment["JAX_PLATFORMS"] = "cuda"  # There is none.
    busy.carry_out(next_run())
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)
    assert row().worker is None, "others may take it"
    assert busy.readiness.problem.kind == "device"
    assert not busy.readiness.check()
    busy.environment["JAX_PLATFORMS"] = "cpu"  # The driver is back.
    assert not busy.readiness.check(), "it is tested again in a while"
    monkeypatch.setattr(readiness.time, "monotonic", lambda now=time.monotonic: now() + 61)
    assert busy.readiness.check()
    assert busy.readiness.problem is None
    assert busy.readiness.device_kinds[0].startswith("cpu, microcosmos ")


@pytest.mark.long
def test_a_self_test_is_believed_until_something_has_changed(services, busy, monkeypatch):
    ready = busy.readiness
    assert ready.check()
    monkeypatch.setattr(readiness, "_self_test", lambda _: ([], Problem("device", "again")))
    same = Readiness(services, Device("a processor", 8 << 30, {}))
    assert same.check()
    assert same.device_kinds == ready.device_kinds
    changed = {"JAX_PLATFORMS": "cuda"}, {"MICROCOSMOS_KERNEL": "jax"}
    for environment in changed:
        assert not Readiness(services, Device("a processor", 8 << 30, environment)).check()
    assert not Readiness(services, Device("another", 8 << 30, {})).check()
    assert not ready.test_device()
    assert not Readiness(services, Device("a processor", 8 << 30, {})).check()


def test_a_self_test_ends_when_its_worker_has_to_stop(busy, monkeypatch):
    monkeypatch.setattr(process_setup, "_stop_requested", True)
    began = time.monotonic()
    assert not busy.readiness.test_device()
    assert busy.readiness.problem == ("untested", "Its self-test fails: the worker has to stop")
    assert time.monotonic() - began < readiness.TEST_SECONDS / 10
