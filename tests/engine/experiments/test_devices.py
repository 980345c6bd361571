"""A search has the same file after every generation on one device and on two."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).with_name("search_bytes.py")


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def files(specs, cache):
    """A function that carries out a run on some devices, compiled as the product is."""

    def run(name, devices):
        given = {"JAX_PLATFORMS": "cpu", "MICROCOSMOS_TEST_CACHE": str(cache), "XLA_FLAGS": ""}
        command = [sys.executable, str(PROGRAM), str(devices), json.dumps(specs[name])]
        done = subprocess.run(
            command, env=os.environ | given, capture_output=True, text=True, check=True
        )
        return json.loads(done.stdout)

    return run


@pytest.mark.long
@pytest.mark.parametrize("name", ["several", "screened"])
def test_the_number_of_devices_changes_no_byte(name, files):
    one, two = (files(name, devices) for devices in (1, 2))
    assert one == two
    assert len(set(one)) == len(one)
