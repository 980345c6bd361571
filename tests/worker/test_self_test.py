"""The self-test of a worker finds a device that is not there or computes wrong numbers."""

import os
import subprocess
import sys

import pytest

from microcosmos.doctor.self_test import EXPECTED, fault
from worker.device import NO_DEVICE


def self_tested(needed):
    """What the self-test says; in a process of its own, since tests of the server fork."""
    command = [sys.executable, "-m", "worker.self_test", needed]
    environment = os.environ | {"JAX_PLATFORMS": "cpu"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    missing = done.stderr.startswith("JAX sees no GPU")
    assert done.returncode == (NO_DEVICE if missing else bool(done.stderr.strip()))
    return done.stderr.strip()


@pytest.mark.long
@pytest.mark.parametrize(("needed", "said"), [("cpu", ""), ("gpu", "JAX sees no GPU, and ")])
def test_a_good_device_passes_and_a_missing_gpu_is_named(needed, said):
    found = self_tested(needed)
    assert found.startswith(said)
    assert bool(found) == bool(said)


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


def test_missing_creatures_are_noticed():
    assert fault(list(EXPECTED[:-1]), exact=True)
