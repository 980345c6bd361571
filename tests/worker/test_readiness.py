"""The self-test of a worker: what it finds, and how long a worker believes it."""

import time

import pytest

from microcosmos.doctor.self_test import EXPECTED, fault
from microcosmos_server.core import processes
from microcosmos_worker import readiness
from microcosmos_worker.device import Device
from microcosmos_worker.readiness import Problem, Readiness


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
    changed = {
        "JAX_PLATFORMS": "cuda",
        "MICROCOSMOS_KERNEL": "jax",
        "MICROCOSMOS_INSTRUCTION_SET": "basic",
    }
    for environment in ({name: value} for name, value in changed.items()):
        assert not Readiness(services, Device("a processor", 8 << 30, environment)).check()
    assert not Readiness(services, Device("another", 8 << 30, {})).check()
    assert not ready.test_device()
    assert not Readiness(services, Device("a processor", 8 << 30, {})).check()


def test_a_worker_tests_itself_again_although_another_has_passed_on_its_device(
    services, monkeypatch, tmp_path
):
    """They share the record of the device, with which they would start."""
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path))
    two = [Readiness(services, Device("a processor", 8 << 30, {})) for _ in range(2)]
    tested = []
    fault = ([], Problem("self-test", "memory"))
    monkeypatch.setattr(readiness, "_self_test", lambda one: tested.append(one) or fault)
    assert [one.check() for one in two] == [False, False]
    fault = (["a cpu"], None)
    monkeypatch.setattr(readiness.time, "monotonic", lambda now=time.monotonic: now() + 61)
    assert [one.check() for one in two] == [True, True]
    assert [one.problem for one in two] == [None, None]
    assert len(tested) == 4


def test_a_self_test_ends_when_its_worker_has_to_stop(busy, monkeypatch):
    monkeypatch.setattr(processes, "_stop_requested", True)
    began = time.monotonic()
    assert not busy.readiness.test_device()
    assert busy.readiness.problem == ("untested", "Its self-test fails: the worker has to stop")
    assert time.monotonic() - began < readiness.TEST_SECONDS / 10


@pytest.mark.parametrize(
    ("status", "last", "problem"),
    [
        (0, '["a cpu"]', None),
        (0, "bye from a library", "it gave no result and ended with status 0"),
        (1, '"a wrong number"', "a wrong number"),
        (-6, '"a wrong number"', "it gave no result and was killed by SIGABRT"),
        (-6, "", "it gave no result and was killed by SIGABRT"),
        (1, "[]", "it gave no result and ended with status 1"),
    ],
)
def test_a_self_test_ends_in_a_result_or_a_problem(busy, monkeypatch, status, last, problem):
    done = processes.Finished(status, f"hello\n{last}\n".encode() if last else b"", b"")
    monkeypatch.setattr(processes, "run", lambda *_, **__: done)
    assert busy.readiness.test_device() == (problem is None)
    found = busy.readiness.problem
    assert found is None or found.text == f"Its self-test fails: {problem}"


def test_the_least_wrong_bit_of_the_kernel_is_noticed():
    assert fault(list(EXPECTED), exact=True) is None
    off = [*EXPECTED[:-1], EXPECTED[-1] * (1 + 1e-7)]
    assert fault(off, exact=True)
    assert fault(off, exact=False) is None


@pytest.mark.parametrize("wrong", [1.02, 0.0, float("nan")])
@pytest.mark.parametrize("place", range(len(EXPECTED)))
def test_a_wrong_number_is_noticed(place, wrong):
    found = [x * wrong if i == place else x for i, x in enumerate(EXPECTED)]
    assert "instead of" in fault(found, exact=False)
