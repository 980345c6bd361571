"""The same creature gives the same bits in any slot, beside anybody, on any devices."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

PROGRAM = Path(__file__).with_name("block_bits.py")


def bits(devices: int, kind: str, tmp_path: Path) -> dict[str, str]:
    given = {"JAX_PLATFORMS": "cpu", "MICROCOSMOS_TEST_CACHE": str(tmp_path)}
    environment = os.environ | given | {"XLA_FLAGS": ""}  # Compiled as the product is.
    command = [sys.executable, str(PROGRAM), str(devices), kind]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module", params=["chain", "grown"])
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def run(kind, cache):
    return bits(1, kind, cache)


def test_slots_and_neighbours_make_no_difference(run):
    assert run["first slot"] == run["last slot"] == run["among others"] == run["alone"]


def test_all_creatures_differ(run):
    assert len(set(run["batch"])) == len(run["batch"])


def test_the_number_of_devices_makes_no_difference(run, kind, cache):
    # Of three devices one has two of the four blocks: they need not share evenly.
    assert bits(3, kind, cache) == run


def test_a_restart_makes_no_difference(run, kind, cache):
    assert bits(1, kind, cache) == run
