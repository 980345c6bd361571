"""A screened search has the same bytes on one device and on several."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).with_name("screened_run.py")


@pytest.mark.long
def test_the_number_of_devices_makes_no_difference(tmp_path):
    given = {"JAX_PLATFORMS": "cpu", "MICROCOSMOS_TEST_CACHE": str(tmp_path / "cache")}
    environment = os.environ | given | {"XLA_FLAGS": ""}  # Compiled as the product is.
    files = []
    for devices in (1, 3):
        path = tmp_path / f"{devices}.h5"
        command = [sys.executable, str(PROGRAM), str(devices), str(path)]
        subprocess.run(command, env=environment, check=True)
        files.append(path.read_bytes())
    assert files[0] == files[1]
