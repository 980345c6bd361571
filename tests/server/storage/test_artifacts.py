"""Files are whole or not there at all."""

import errno

import pytest

from server.storage import artifacts
from server.storage.artifacts import Artifacts, superfluous


@pytest.fixture
def files(tmp_path) -> Artifacts:
    return Artifacts(str(tmp_path))


def test_files_are_read_as_written(files):
    stored = files.write("runs/1/a.h5", b"content")
    assert files.read(stored.path) == b"content"
    assert b"".join(files.stream(stored.path, 2, 5)) == b"nte"


def test_a_full_disk_leaves_the_previous_file_and_no_part(files, tmp_path, monkeypatch):
    files.write("runs/1/a.h5", b"before")

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(artifacts.os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        files.write("runs/1/a.h5", b"after")
    assert files.read("runs/1/a.h5") == b"before"
    assert [file.name for file in (tmp_path / "runs/1").iterdir()] == ["a.h5"]


def test_the_last_three_and_every_tenth_checkpoint_are_kept():
    kept, numbers = [], []
    for number in range(1, 35):
        numbers = [n for n in [*kept, number]]
        kept = [n for n in numbers if n not in superfluous(numbers)]
    assert kept == [10, 20, 30, 32, 33, 34]


def test_deleting_what_is_gone_is_no_error(files):
    files.delete("runs/1/never.h5")
