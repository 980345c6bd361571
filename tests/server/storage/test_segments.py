"""Checkpoints in segments: what a run only appends is stored once, and nothing is lost."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
from deletion import delete_for_good
from object_store import new_prefix
from sqlalchemy import select, update

from microcosmos.archive import file
from microcosmos_server.attempts.checkpoints import CheckpointUnavailable, last_checkpoint
from microcosmos_server.core.errors import FileLost, StoreUnavailable
from microcosmos_server.deletion import purge
from microcosmos_server.maintenance import backup
from microcosmos_server.storage import segments
from microcosmos_server.storage.artifacts import Artifacts
from microcosmos_server.storage.garbage import remove_files
from microcosmos_server.storage.segments import Segments
from microcosmos_server.tables import CHECKPOINT, SEGMENT, Artifact, Generation

SIZE = 1024
GROWING = ("curves", "lineage")
ENTRIES = 150
"""Entries of a generation, of 36 bytes: a few segments."""


def archive(generation: int, last: float = 0.0) -> bytes:
    """Return a file whose lineage and curve grow; of everything else every byte changes."""
    random = np.random.default_rng(7)
    rows = ENTRIES * generation
    curve = np.arange(generation, dtype=float)
    curve[-1:] += last
    tree = {
        "archive": {"genomes": np.full(100, generation, np.int32)},
        "curves": {"best": curve},
        "lineage": {
            "creature": random.integers(0, 256, (10_000, 32), np.uint8)[:rows],
            "generation": np.repeat(np.arange(generation, dtype=np.int32), ENTRIES),
        },
    }
    return file.dump(tree, {"format": file.FORMAT})


@pytest.fixture
def services(services, monkeypatch):
    monkeypatch.setattr(services.settings, "segment_bytes", SIZE)
    return services


@pytest.fixture
def begin(claim_run):
    """Claims the run; what its attempt saves is in segments."""

    def begin():
        attempt = claim_run()
        attempt.segments.growing = GROWING
        return attempt

    return begin


@pytest.fixture
def attempt(begin):
    return begin()


@pytest.fixture
def save(attempt, record):
    def save(*generations):
        for generation in generations:
            record(generation, {generation: 1.0})
            attempt.save(generation, archive(generation))

    return save


@pytest.fixture
def folder(services, run_id) -> Path:
    return services.settings.data / "artifacts" / "runs" / str(run_id)


@pytest.fixture
def rows(services, run_id):
    def read(kind):
        mine = (Artifact.run_id == run_id) & (Artifact.kind == kind)
        with services.sessions.read() as session:
            found = session.scalars(select(Artifact).where(mine)).all()
        return sorted(found, key=lambda row: (row.generation, row.path))

    return read


def content(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(params=["folder", "s3"])
def store(request, tmp_path) -> Artifacts:
    if request.param == "folder":
        return Artifacts(str(tmp_path / "store"))
    request.getfixturevalue("object_store")
    return Artifacts(new_prefix())


def row_of(written) -> Artifact:
    whole = written.whole
    return Artifact(
        **vars(written.file),
        whole_size=whole and whole.size,
        whole_sha256=whole and whole.sha256,
    )


def test_head_and_segments_are_the_file_and_any_part_of_it(store):
    known, data = Segments(GROWING), archive(5)
    row = row_of(segments.write(store, "runs/1/00000005-1-abc.h5", data, known, SIZE))
    whole = segments.whole(row)
    assert (whole.size, whole.sha256) == (len(data), hashlib.sha256(data).hexdigest())
    assert row.size < len(data) / 2
    assert segments.read(store, row) == data
    assert segments.read_intact(store, row) == (data, known.stored)
    for start in (0, 1, SIZE, 1000, len(data) - 300, len(data)):
        for stop in (start, start + 1, start + 2 * SIZE, len(data)):
            stop = max(start, min(stop, len(data)))
            assert b"".join(segments.stream(store, row, start, stop)) == data[start:stop]


def test_a_missing_head_is_found_before_the_first_byte_is_sent(store):
    row = row_of(segments.write(store, "runs/1/a.h5", archive(5), Segments(GROWING), SIZE))
    store.delete(row.path)
    with pytest.raises(FileLost):
        segments.stream(store, row, 0, 5)
    with pytest.raises(FileLost):
        segments.read(store, row)


def test_a_lost_checkpoint_is_a_problem_that_names_it(api, services, run_id, save):
    save(1)
    (head,) = Path(services.artifacts.root).glob("runs/*/*.head")
    head.unlink()
    for path in ("archive.h5", "archive.csv", "export/newick"):
        problem = api.get(f"runs/{run_id}/{path}").json()
        said = f"The store has lost runs/{run_id}/{head.name}; restore it from a backup."
        assert (problem["status"], problem["title"], problem["detail"]) == (
            500,
            "File lost",
            said,
        )


def test_the_sizes_of_files_are_those_in_the_store(store):
    for name, data in {"a": b"1", "b": b"22", "c": b""}.items():
        store.write(f"runs/1/{name}", data)
    paths = [f"runs/1/{name}" for name in "abcd"]
    assert store.sizes(paths) == dict(zip(paths, (1, 2, 0), strict=False))
    assert store.sizes([]) == store.sizes(["runs/2/a"]) == {}


def test_a_file_without_a_full_piece_is_stored_whole(store):
    """The last row may change, so a piece that ends its column is not full."""
    known = Segments(("curves",))
    exact = file.dump({"curves": {"best": np.zeros(SIZE // 8)}}, {})
    longer = file.dump({"curves": {"best": np.zeros(SIZE // 8 + 1)}}, {})
    assert segments.write(store, "runs/1/a.h5", exact, known, SIZE).whole is None
    assert store.read("runs/1/a.h5") == exact
    assert len(segments.write(store, "runs/1/b.h5", longer, known, SIZE).new) == 1
    assert segments.write(store, "runs/1/c.h5", longer, Segments(), SIZE).whole is None


@pytest.mark.postgresql
def test_a_checkpoint_writes_what_is_new(save, folder, rows, services, monkeypatch):
    sizes = []
    write = Artifacts.write

    def counted(self, path, data):
        sizes.append(len(data))
        return write(self, path, data)

    monkeypatch.setattr(Artifacts, "write", counted)
    written = []
    for generation in range(1, 31):
        sizes.clear()
        save(generation)
        written.append(sum(sizes))
    new = ENTRIES * 36 + 8
    assert len(archive(30)) > 30 * new
    unfull, listed, rest = 3 * SIZE, 130 * (30 * new // SIZE), len(archive(1)) - new
    assert max(written) < new + SIZE + unfull + listed + rest
    assert sum(written) < 30 * (new + unfull + rest) + 30 * listed / 2 + SIZE
    names = {row.path for kind in (CHECKPOINT, SEGMENT) for row in rows(kind)}
    while remove_files(services.sessions, services.artifacts):
        pass
    assert {path.name for path in folder.iterdir()} == {name.split("/")[-1] for name in names}
    stored = sum(path.stat().st_size for path in folder.glob("*.segment"))
    assert stored <= len(archive(30)), "no row is stored twice"


@pytest.mark.postgresql
def test_each_kept_checkpoint_is_whole_and_a_resumed_run_writes_only_what_is_new(
    save, begin, services, rows, folder
):
    save(*range(1, 13))
    while remove_files(services.sessions, services.artifacts):
        pass
    kept = rows(CHECKPOINT)
    assert [row.generation for row in kept] == [10, 11, 12]
    for row in kept:
        data, _ = segments.read_intact(services.artifacts, row)
        assert data == segments.read(services.artifacts, row) == archive(row.generation)
    before = content(folder)
    again = begin()
    assert again.restore() == archive(12)
    again.save(12, archive(12))
    new = content(folder).keys() - before.keys()
    assert [Path(name).suffix for name in new] == [".head"]
    assert again.restore() == archive(12)


@pytest.mark.postgresql
def test_a_run_that_is_killed_before_the_head_goes_on_from_the_checkpoint_before(
    save, begin, record, report, attempt, services, folder, monkeypatch, rows
):
    save(1, 2)
    record(3, {3: 1.0})
    write = Artifacts.write

    class Killed(BaseException):
        pass

    def killed(self, path, data):
        if path.endswith(".head"):
            raise Killed
        return write(self, path, data)

    before = content(folder)
    with monkeypatch.context() as patch:
        patch.setattr(Artifacts, "write", killed)
        with pytest.raises(Killed):
            attempt.save(3, archive(3))
    left = content(folder).keys() - before.keys()
    assert left
    assert all(name.endswith(".segment") for name in left)
    again = begin()
    assert again.restore() == archive(2)
    again.record(report(3, {3: 1.0}), 1.0)
    again.save(3, archive(3))
    assert begin().restore() == archive(3)
    assert left.isdisjoint(Path(row.path).name for row in rows(SEGMENT))
    assert backup.check(services)[1] == []


def test_a_head_that_could_not_be_written_costs_no_segment_twice(
    save, attempt, record, folder, monkeypatch, services, rows
):
    save(1)
    record(2)
    write = Artifacts.write

    def full(self, path, data):
        if path.endswith(".head"):
            raise OSError(28, "No space left on device")
        return write(self, path, data)

    with monkeypatch.context() as patch:
        patch.setattr(Artifacts, "write", full)
        for _ in range(3):
            with pytest.raises(OSError, match="No space"):
                attempt.save(2, archive(2))
    written = set(content(folder))
    attempt.save(2, archive(2))
    assert len(content(folder).keys() - written) == 1
    assert attempt.restore() == archive(2)
    named = {Path(row.path).name for row in rows(SEGMENT)}
    assert named == {path.name for path in folder.glob("*.segment")}
    assert backup.check(services)[1] == []


def rot(folder, first, second):
    (folder / first).write_bytes(b"rot")


def swap(folder, first, second):
    """Each segment is intact, but not in its place."""
    (folder / first).rename(folder / "moved")
    (folder / second).rename(folder / first)
    (folder / "moved").rename(folder / second)


@pytest.mark.postgresql
@pytest.mark.parametrize("harm", [rot, swap])
def test_older_checkpoints_stand_in_if_they_need_no_damaged_segment(
    save, begin, folder, rows, row, count, harm, services, report
):
    save(1, 2, 3)
    third = [Path(one.path).name for one in rows(SEGMENT) if one.generation == 3]
    harm(folder, *third[:2])
    again = begin()
    assert again.restore() == archive(2)
    assert (again.generation, row().generation, count(Generation)) == (2, 2, 2)
    assert "generation 3 is damaged" in row().warning
    assert [one.generation for one in rows(CHECKPOINT)] == [1, 2]
    assert {one.generation for one in rows(SEGMENT)} == {1, 2}
    again.record(report(3, {3: 1.0}), 1.0)
    again.save(3, archive(3))
    assert remove_files(services.sessions, services.artifacts)
    assert not any((folder / name).exists() for name in third)
    assert begin().restore() == archive(3)
    assert backup.check(services)[1] == []


def test_a_head_that_names_segments_in_another_order_is_damaged(
    save, begin, folder, rows, services
):
    """Files and database agree: the digest of the whole file tells."""
    save(1, 2, 3)
    last = rows(CHECKPOINT)[-1]
    head = (folder / Path(last.path).name).read_bytes()
    length = int.from_bytes(head[:4], "little")
    header = json.loads(head[4 : 4 + length])
    first, second = header["segments"][-2:]
    first[2:], second[2:] = second[2:], first[2:]
    forged = json.dumps(header).encode()
    forged = len(forged).to_bytes(4, "little") + forged + head[4 + length :]
    (folder / Path(last.path).name).write_bytes(forged)
    with services.sessions.write.begin() as session:
        values = {"size": len(forged), "sha256": hashlib.sha256(forged).hexdigest()}
        session.execute(update(Artifact).where(Artifact.path == last.path).values(**values))
    assert begin().restore() == archive(2)


@pytest.mark.postgresql
def test_a_missing_segment_is_named_and_deletes_nothing(
    save, begin, folder, rows, row, count, services
):
    save(1, 2)
    lost = rows(SEGMENT)[-1]
    content = (folder / Path(lost.path).name).read_bytes()
    (folder / Path(lost.path).name).unlink()
    before = count(Artifact)
    with pytest.raises(CheckpointUnavailable, match="generation 2 lacks a segment") as caught:
        begin().restore()
    assert lost.path in str(caught.value)
    assert (row().generation, row().checkpoint_generation) == (2, 2)
    assert count(Artifact) == before
    assert backup.check(services)[1] == [f"{lost.path} is missing or has changed"]
    (folder / Path(lost.path).name).write_bytes(content)
    assert begin().restore() == archive(2)


def test_if_all_are_damaged_the_segment_is_named(save, begin, folder, rows, count):
    save(1, 2)
    first = rows(SEGMENT)[0]
    (folder / Path(first.path).name).write_bytes(b"rot")
    before = count(Artifact)
    with pytest.raises(CheckpointUnavailable, match="all before it are damaged") as caught:
        begin().restore()
    assert first.path in str(caught.value)
    assert count(Artifact) == before


def test_the_next_checkpoint_writes_lost_segments_again(
    save, attempt, record, begin, folder, rows
):
    save(1, 2)
    for one in rows(SEGMENT)[:2]:
        (folder / Path(one.path).name).unlink()
    record(3, {3: 1.0})
    attempt.save(3, archive(3))
    assert begin().restore() == archive(3)


@pytest.mark.parametrize("some", [slice(None), slice(-1, None)], ids=["all", "the last"])
def test_a_segment_that_rots_while_the_run_goes_on_is_written_again(
    save, attempt, begin, folder, some
):
    """Its size stays the same, and all later checkpoints would name it."""
    save(1, 2, 3, 4)
    known = list(attempt.segments.stored.values())
    assert len(known) > 2 * segments.VERIFIED  # They are verified in turn.
    for one in known[some]:
        damaged = folder / Path(one.path).name
        damaged.write_bytes(bytes(damaged.stat().st_size))
    save(*range(5, 5 + len(known) // segments.VERIFIED + 1))
    assert begin().restore() is not None
    assert begin().generation == attempt.generation


def test_a_store_that_does_not_answer_leaves_the_last_checkpoint(
    save, attempt, record, monkeypatch
):
    save(1)
    record(2)

    def away(self, paths):
        raise StoreUnavailable("away")

    with monkeypatch.context() as patch:
        patch.setattr(Artifacts, "sizes", away)
        assert not attempt.checkpoint(2, archive(2))
    assert attempt.restore() == archive(1)
    assert attempt.checkpoint(2, archive(2))
    assert attempt.restore() == archive(2)


def test_an_extended_run_changes_its_last_row_and_no_segment(save, attempt, rows, begin):
    save(1, 2, 3)
    before = [one.path for one in rows(SEGMENT)]
    attempt.save(3, archive(3, last=1.0))
    assert [one.path for one in rows(SEGMENT)] == before
    assert begin().restore() == archive(3, last=1.0)


@pytest.mark.postgresql
def test_downloads_are_the_whole_file(save, api, run_id):
    save(1, 2, 3)
    address, data = f"runs/{run_id}/archive.h5", archive(3)
    whole = api.get(address)
    assert whole.content == data
    assert whole.headers["content-length"] == str(len(data))
    tag = f'"{hashlib.sha256(data).hexdigest()}"'
    assert whole.headers["etag"] == tag
    assert api.get(address, headers={"If-None-Match": tag}).status_code == 304
    for start, stop in ((0, 10), (len(data) // 2, len(data) // 2 + 3 * SIZE), (5, len(data))):
        asked = {"Range": f"bytes={start}-{stop - 1}", "If-Range": tag}
        part = api.get(address, headers=asked)
        assert (part.status_code, part.content) == (206, data[start:stop])
        assert part.headers["content-range"] == f"bytes {start}-{stop - 1}/{len(data)}"
    late = api.get(address, headers={"Range": f"bytes={len(data)}-"})
    assert late.status_code == 416


@pytest.mark.postgresql
def test_an_ended_run_keeps_the_segments_of_its_last_checkpoint(
    save, attempt, api, run_id, services, rows, monkeypatch
):
    save(1, 2, 3)
    attempt.finish()
    before = {one.path for one in rows(SEGMENT)}
    monkeypatch.setattr(services.settings, "keep_checkpoints", -1.0)
    purge.expire(services)
    assert remove_files(services.sessions, services.artifacts)
    assert [one.generation for one in rows(CHECKPOINT)] == [3]
    assert {one.path for one in rows(SEGMENT)} == before
    assert api.get(f"runs/{run_id}/archive.h5").content == archive(3)


@pytest.mark.postgresql
def test_a_deleted_run_leaves_no_segment(save, attempt, api, run_id, services, folder, count):
    save(1, 2, 3)
    attempt.finish()
    delete_for_good(api, services, run_id)
    assert count(Artifact) == 0
    assert not folder.exists()


@pytest.mark.postgresql
def test_a_backup_has_the_segments_of_its_checkpoints(save, services, tmp_path, run_id):
    save(1, 2, 3)
    made = backup.make(services, tmp_path / "backup")
    assert made.faults == []
    with services.sessions.read() as session:
        last = last_checkpoint(session, run_id)
    copies = Artifacts(str(tmp_path / "backup" / backup.FILES))
    assert segments.read_intact(copies, last)[0] == archive(3)
    assert len(made.files) == len(list(Path(copies.root, "runs").rglob("*.*")))
