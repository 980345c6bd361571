"""A checkpoint that cannot be written costs nothing but time."""

import io
import os
import shutil
import subprocess
from contextlib import suppress

import h5py
import pytest

pytestmark = pytest.mark.long


@pytest.fixture
def small_disk(tmp_path):
    """A folder on a file system of its own, of four megabytes."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", str(folder)]
    if os.geteuid() or subprocess.run(mount, check=False, capture_output=True).returncode:
        pytest.skip("mounting a small disk needs root")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def fill(folder):
    """Leave not a byte; the file that takes it."""
    ballast = folder / "ballast"
    with suppress(OSError), ballast.open("wb", 0) as file:
        while True:
            file.write(bytes(4096))
    assert not shutil.disk_usage(folder).free
    return ballast


def test_a_full_disk_leaves_the_last_checkpoint_and_the_run_says_so(
    small_disk, installation, spec, undisturbed
):
    place = installation(MICROCOSMOS_ARTIFACTS_URL=str(small_disk))
    place.start()
    run = place.submit(spec)
    place.reach(run, 3)
    ballast = fill(small_disk)
    paused = place.wait(run, "paused")
    assert "No space left on device" in paused["warning"]
    with h5py.File(io.BytesIO(place.archive(run))) as archive:
        assert 0 < archive["loop/generation"][()] < spec["search"]["generations"]
    ballast.unlink()
    place.ask(run, "resume")
    assert place.wait(run, "finished")["warning"] is None
    assert place.archive(run) == undisturbed.archive
    assert place.told(run) == undisturbed.told
