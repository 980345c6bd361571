"""Files are deterministic, complete or absent, and readable by other programs."""

import errno
import fcntl
import json
import os
import re
import resource
import signal
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from io import BytesIO
from unittest.mock import Mock

import h5py
import numpy as np
import pytest

from microcosmos.archive import atomic, creature, creature_h5, export, file
from microcosmos.archive.atomic import folder_part, write_whole
from microcosmos.naming import decode
from microcosmos.spec import shape


@pytest.mark.fast
def test_the_same_content_gives_the_same_bytes():
    tree = {"b": {"x": np.arange(5), "y": np.zeros((0, 3))}, "a": np.float64(2)}
    attributes = {"format": file.FORMAT, "spec": "{}"}
    data = file.dump(tree, attributes)
    assert data == file.dump(dict(reversed(tree.items())), attributes)
    back, loaded = file.load(data)
    assert loaded == attributes
    np.testing.assert_array_equal(back["b"]["x"], tree["b"]["x"])
    assert back["b"]["y"].shape == (0, 3)


@pytest.mark.fast
def test_something_else_than_an_archive_is_refused():
    with pytest.raises(ValueError, match="HDF5"):
        file.load(b"something else")
    with pytest.raises(ValueError, match="`format`"):
        file.load(file.dump({}, {"format": "recipe"}))


def test_attributes_that_h5py_wrote_as_text_are_read(tmp_path):
    path = tmp_path / "copied.h5"
    path.write_bytes(file.dump({"a": np.arange(3)}, {"format": file.FORMAT, "title": "ж"}))
    with h5py.File(path, "r+") as opened:
        for name, value in file.attributes_of(opened).items():
            opened.attrs[name] = value  # Of variable length, as any copy by h5py's users.
        opened.attrs["number"] = 5
    tree, attributes = file.load(path.read_bytes())
    assert tree["a"].tolist() == [0, 1, 2]
    assert attributes == {"format": file.FORMAT, "title": "ж", "number": "5"}
    with h5py.File(path, "r+") as opened:
        opened.attrs["format"] = "recipe/1"
    with pytest.raises(ValueError, match="must be microcosmos-archive/1, got recipe/1"):
        file.load(path.read_bytes())


@pytest.mark.fast
def test_damage_is_refused_in_our_words():
    """HDF5's objects have checksums, its arrays none."""
    tree = {"a": np.float64(2), "b": {"x": np.arange(5)}}
    data = file.dump(tree, {"format": file.FORMAT, "spec": "{}"})
    refused = 0
    for place in range(0, len(data), 11):
        damaged = bytearray(data)
        damaged[place] ^= 0x41
        try:
            file.load(bytes(damaged))
        except ValueError:
            refused += 1
    assert refused > 25
    with pytest.raises(ValueError, match="must be from 0 to 1; got -1"):
        file.words(np.array([0, 1, -1]), ["mutation", "random"])


def elsewhere(opened):
    opened.create_dataset("a/b", (8,), "u1", external=[(opened.attrs["outside"], 0, 8)])


def virtual(opened):
    layout = h5py.VirtualLayout((8,), "u1")
    layout[:] = h5py.VirtualSource(opened.attrs["outside"], "x", (8,), "u1")
    opened.create_virtual_dataset("a/b", layout)


def linked(opened):
    opened["a/b"] = h5py.ExternalLink(opened.attrs["outside"], "/")


def huge(opened):
    opened.create_dataset("a/b", (1 << 44,), "f4", chunks=(1 << 16,))


def of_a_type(opened):
    opened["a/b"] = np.dtype("f4")


@pytest.mark.fast
@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (elsewhere, "be stored in the file, got external storage"),
        (virtual, "be stored in the file, got a virtual dataset"),
        (linked, "lie in the file itself, got ExternalLink"),
        (huge, r"have at most [\d,]+ bytes, .* of this size can hold; got 70,368,744,177,664"),
        (of_a_type, "be an array or a group, got a type"),
    ],
)
def test_an_archive_file_is_read_from_itself_and_within_its_size(tmp_path, edit, words):
    other, stored = tmp_path / "other.h5", BytesIO()
    other.write_bytes(file.dump({"x": np.arange(8, dtype="u1")}, {"format": "other"}))
    with h5py.File(stored, "w") as opened:
        opened.attrs.update({"format": file.FORMAT, "outside": str(other)})
        edit(opened)
    with pytest.raises(ValueError, match=f"^`/a/b` must {words}"):
        file.load(stored.getvalue())


@pytest.mark.fast
def test_a_copy_with_filters_is_read():
    stored, zeros = BytesIO(), np.zeros(1 << 22)
    with h5py.File(stored, "w") as opened:
        opened.attrs["format"] = file.FORMAT
        opened.create_dataset("a", data=zeros, compression="gzip", compression_opts=9)
    assert len(stored.getvalue()) < zeros.nbytes / 400
    np.testing.assert_array_equal(file.load(stored.getvalue())[0]["a"], zeros)


@pytest.mark.fast
def test_a_file_that_exceeds_the_memory_is_refused(monkeypatch):
    monkeypatch.setattr(file, "_read", Mock(side_effect=MemoryError("8 GiB are needed")))
    with pytest.raises(ValueError, match="must fit into memory: 8 GiB are needed"):
        file.load(file.dump({}, {"format": file.FORMAT}))


@pytest.mark.fast
def test_a_write_that_fails_leaves_the_old_file_and_nothing_beside_it(tmp_path, monkeypatch):
    path = tmp_path / "archive.h5"
    write_whole(path, b"old")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(OSError, match="too large"):
            write_whole(path, b"x" * 100_000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
    monkeypatch.setattr(os, "fsync", Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        write_whole(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.fast
def test_a_write_removes_what_a_killed_one_left_and_no_part_of_a_living_one(tmp_path):
    path, other = tmp_path / "a[1].h5", tmp_path / "b.h5"
    killed, of_other = atomic.part_of(path), atomic.part_of(other)
    download = tmp_path / f".a[1].h5.{'0f' * 32}.part"
    kept = [atomic.part_of(path), atomic.part_of(path), of_other, download]
    for part in (killed, *kept):
        part.write_bytes(b"half")
    with kept[0].open("rb+") as written, kept[1].open("wb"):  # The latter is not locked yet.
        fcntl.flock(written, fcntl.LOCK_EX)
        write_whole(path, b"whole")
    assert set(tmp_path.iterdir()) == {path, *kept}
    assert path.read_bytes() == b"whole"
    write_whole(other, b"whole")
    assert not of_other.exists()


@pytest.mark.fast
def test_a_file_has_any_name_that_the_system_takes(tmp_path):
    path = tmp_path / f"{'a' * 252}.h5"
    for content in (b"old", b"new"):
        write_whole(path, content)
        assert path.read_bytes() == content
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.fast
def test_an_error_names_the_file_that_was_asked_for(tmp_path, monkeypatch):
    (tmp_path / "file").write_bytes(b"")
    for folder, kind in (("missing", FileNotFoundError), ("file", NotADirectoryError)):
        path = tmp_path / folder / "a.h5"
        for write in (partial(write_whole, data=b""), lambda to: folder_part(to).__enter__()):
            with pytest.raises(kind) as caught:
                write(path)
            assert caught.value.filename == str(path)

    def full(opened):
        raise OSError(errno.ENOSPC, "No space left on device")

    path = tmp_path / "a.h5"
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match=re.escape(f"No space left on device: '{path}'")):
        write_whole(path, b"whole")
    assert [one.name for one in tmp_path.iterdir()] == ["file"]


@pytest.mark.fast
def test_a_folder_that_may_be_written_and_not_listed_takes_a_file(tmp_path, monkeypatch):
    def refuse(path, *given, found):
        if path == (tmp_path if isinstance(path, type(tmp_path)) else str(tmp_path)):
            raise PermissionError(13, "Permission denied", str(path))
        return found(path, *given)

    # Root may list any folder.
    for name in ("open", "scandir", "listdir"):
        monkeypatch.setattr(os, name, partial(refuse, found=getattr(os, name)))
    write_whole(tmp_path / "a.h5", b"whole")
    assert (tmp_path / "a.h5").read_bytes() == b"whole"


@pytest.mark.fast
def test_links_are_followed_and_nothing_but_files_is_replaced(tmp_path):
    target, link, dangling = (tmp_path / name for name in ("a.h5", "link.h5", "new.h5"))
    target.write_bytes(b"old")
    link.symlink_to("a.h5")
    dangling.symlink_to("b.h5")
    write_whole(link, b"whole")
    write_whole(dangling, b"new")
    assert (link.readlink().name, target.read_bytes()) == ("a.h5", b"whole")
    assert (dangling.is_symlink(), (tmp_path / "b.h5").read_bytes()) == (True, b"new")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "circle").symlink_to("circle")
    for name, words in (("pipe", "a file is needed, got"), ("circle", "symbolic links")):
        with pytest.raises(OSError, match=words):
            write_whole(tmp_path / name, b"whole")
    assert (tmp_path / "pipe").is_fifo()


@pytest.mark.fast
def test_a_file_keeps_its_permissions_and_its_content_without_one_to_write(
    tmp_path, monkeypatch
):
    path = tmp_path / "a.h5"
    path.write_bytes(b"old")
    for mode in (0o600, 0o640):
        path.chmod(mode)
        write_whole(path, b"new")
        assert (path.stat().st_mode & 0o777, path.read_bytes()) == (mode, b"new")
    # Root may write any file.
    monkeypatch.setattr(os, "access", lambda *asked: asked != (path, os.W_OK))
    with pytest.raises(PermissionError, match=r"may be written is needed, got .*a\.h5"):
        write_whole(path, b"newer")
    assert path.read_bytes() == b"new"


def test_threads_write_one_file_at_once(tmp_path):
    path = tmp_path / "a.h5"
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda number: write_whole(path, b"%d" % number * 9999), range(40)))
    assert len(set(path.read_bytes().decode())) <= 2
    assert list(tmp_path.iterdir()) == [path]


def test_a_creature_file_survives_hdf5_with_the_same_bytes(newcomer):
    credited = {**newcomer, "credit": ["Ada", "Bob"], "licence": "CC0-1.0"}
    assert creature_h5.load(creature_h5.dump(newcomer)) == newcomer
    assert creature_h5.load(creature_h5.dump(credited)) == credited
    shuffled = json.loads(json.dumps(dict(reversed(newcomer.items()))))
    assert creature_h5.dump(creature.parse(shuffled)) == creature_h5.dump(newcomer)


def test_body_genes_and_figures_are_arrays(newcomer):
    genome, body = newcomer["identity"]["genome"], shape(creature.scene_of(newcomer).body)
    with h5py.File(BytesIO(creature_h5.dump(newcomer)), "r") as found:
        assert found.attrs["sha256"].decode() == newcomer["sha256"]
        np.testing.assert_array_equal(found["body/positions"], body.positions)
        weights = found["genome/connections/weight"]
        np.testing.assert_array_equal(weights, decode(genome["connections"]["weight"]))
        names = [name.decode() for name in found["genome/nodes/activation"]]
        assert names == list(genome["nodes"]["activation"])
        measured = newcomer["measured"]
        assert found["measured/fitness"][()] == measured["fitness"]
        for group in ("measures", "descriptors"):
            arrays = {name: item[()] for name, item in found[f"measured/{group}"].items()}
            assert arrays == measured[group]


NAMES = ["", ".", "..", "/", "a", "a/b", "a/b/../c", "./a", "%", "%2F", "a%2Fb", "nul\0"]
NAMES += ["fitness", "measures", "1/2 é", " ", "%2E", "x" * 200]


def test_names_that_could_be_paths_are_names(newcomer):
    measures = {name: float(number) for number, name in enumerate(NAMES)}
    measured = newcomer["measured"]
    measured = measured | {"measures": measured["measures"] | measures}
    named = creature.parse(newcomer | {"measured": measured})
    data = creature_h5.dump(named)
    assert creature_h5.load(data) == named
    assert len({creature_h5.link(name) for name in NAMES}) == len(NAMES)
    with h5py.File(BytesIO(data), "r") as found:
        assert found["measured/fitness"][()] == newcomer["measured"]["fitness"]
        group = found["measured/measures"]
        assert {name: group[creature_h5.link(name)][()] for name in NAMES} == measures


LINKS = [h5py.ExternalLink("other.h5", "/"), h5py.SoftLink("/identity")]


@pytest.mark.parametrize("link", LINKS)
def test_links_out_of_the_file_are_refused(newcomer, link):
    stored = BytesIO(creature_h5.dump(newcomer))
    with h5py.File(stored, "r+") as found:
        del found["body/positions"]
        found["body/positions"] = link
    with pytest.raises(ValueError, match="`/body/positions` must lie in the file itself"):
        creature_h5.load(stored.getvalue())


@pytest.mark.fast
def test_a_missing_package_is_named_with_its_command(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match='pip install "pandas"'):
        export.to_pandas(b"")
