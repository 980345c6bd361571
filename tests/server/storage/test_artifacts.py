"""Files are whole or not there at all, in a folder and in S3."""

import errno
import os

import pytest
from object_store import new_prefix
from pydantic import ValidationError

from microcosmos_server.core.errors import FileLost, StoreUnavailable
from microcosmos_server.settings import Settings
from microcosmos_server.storage import artifacts
from microcosmos_server.storage.artifacts import CHUNK, Artifacts, superfluous


@pytest.fixture(params=["folder", "s3"])
def files(request, tmp_path) -> Artifacts:
    if request.param == "folder":
        return Artifacts(str(tmp_path))
    request.getfixturevalue("object_store")
    return Artifacts(new_prefix())


def test_files_are_read_as_written(files):
    stored = files.write("runs/1/a.h5", b"content")
    assert files.read(stored.path) == b"content"
    assert files.read(stored.path, 1, 4) == b"ont"
    assert b"".join(files.stream(stored.path, 2, 5)) == b"nte"
    assert files.read_verified(stored.path, stored.sha256) == b"content"
    assert files.read_verified(stored.path, "0" * 64) is None
    files.write("runs/1/a.h5", b"another")
    assert files.read("runs/1/a.h5") == b"another"


def test_a_large_file_is_streamed_in_pieces(files):
    content = os.urandom(CHUNK + 1000)
    stored = files.write("runs/1/large.h5", content)
    pieces = list(files.stream(stored.path, 5, len(content)))
    assert [len(piece) for piece in pieces] == [CHUNK, 995]
    assert b"".join(pieces) == content[5:]


def test_a_missing_file_is_no_outage(files):
    with pytest.raises(FileLost):
        files.read("runs/1/never.h5")
    with pytest.raises(FileLost):
        files.stream("runs/1/never.h5", 0, 5)
    assert files.read_verified("runs/1/never.h5", "0" * 64) is None


def test_deleting_a_folder_leaves_its_neighbours(files):
    for path in ("runs/1/a.h5", "runs/1/b.h5", "runs/10/a.h5", "runs/2/a.h5"):
        files.write(path, b"content")
    files.delete("runs/2/a.h5")
    files.delete("runs/1/")
    for path in ("runs/1/a.h5", "runs/1/b.h5", "runs/2/a.h5"):
        assert files.read_verified(path, "") is None
        with pytest.raises(FileLost):
            files.read(path)
    assert files.read("runs/10/a.h5") == b"content"


def test_deleting_what_is_gone_is_no_error(files):
    files.delete("runs/1/never.h5")
    files.delete("runs/1/")


def test_a_folder_that_was_moved_to_another_disk_is_deleted_there(tmp_path):
    files = Artifacts(str(tmp_path / "store"))
    files.write("runs/1/a.h5", b"content")
    folder = tmp_path / "store" / "runs" / "1"
    moved = folder.rename(tmp_path / "moved")
    folder.symlink_to(moved)
    files.delete("runs/1/")
    assert not moved.exists()
    assert not folder.is_symlink()


def test_a_full_disk_leaves_the_previous_file_and_no_part(tmp_path, monkeypatch):
    files = Artifacts(str(tmp_path))
    files.write("runs/1/a.h5", b"before")

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(artifacts.os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        files.write("runs/1/a.h5", b"after")
    assert files.read("runs/1/a.h5") == b"before"
    assert [file.name for file in (tmp_path / "runs/1").iterdir()] == ["a.h5"]


def test_single_errors_of_the_server_are_not_noticed(object_store):
    files = Artifacts(new_prefix())
    object_store.failures = 1
    files.write("runs/1/a.h5", b"content")
    object_store.failures = 1
    assert files.read("runs/1/a.h5") == b"content"
    assert object_store.failures == 0


def test_a_server_that_fails_raises_and_leaves_the_previous_file(object_store):
    files = Artifacts(new_prefix())
    files.write("runs/1/a.h5", b"before")
    object_store.failing = ""
    for act in (
        lambda: files.write("runs/1/a.h5", b"after"),
        lambda: files.read("runs/1/a.h5"),
        lambda: files.stream("runs/1/a.h5", 0, 3),
        lambda: files.delete("runs/1/a.h5"),
    ):
        with pytest.raises(StoreUnavailable, match="Service Unavailable"):
            act()
    object_store.failing = None
    assert files.read("runs/1/a.h5") == b"before"


def test_a_server_that_is_not_there_is_an_outage(monkeypatch, object_store):
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:1")
    files = Artifacts(new_prefix())
    for act in (lambda: files.write("a", b""), lambda: files.read("a")):
        with pytest.raises(StoreUnavailable, match="endpoint URL: the store"):
            act()


@pytest.mark.parametrize(
    ("url", "needed"),
    [
        ("gs://bucket/prefix", "must be a folder or s3://BUCKET/PREFIX; got gs://"),
        ("file://", "must be a folder or s3://BUCKET/PREFIX"),
        ("s3://", "must be a folder or s3://BUCKET/PREFIX"),
        ("s3://key:hidden@bucket/prefix", "credentials into AWS_ACCESS_KEY_ID"),
    ],
)
def test_other_stores_are_refused_by_name(url, needed):
    with pytest.raises(ValidationError, match="artifacts_url") as caught:
        Settings(artifacts_url=url)
    assert needed in caught.value.errors()[0]["msg"]


def test_the_last_three_and_every_tenth_checkpoint_are_kept():
    kept, numbers = [], []
    for number in range(1, 35):
        numbers = [n for n in [*kept, number]]
        kept = [n for n in numbers if n not in superfluous(numbers)]
    assert kept == [10, 20, 30, 32, 33, 34]
