"""Malformed HDF5 files of creatures, and some that refer to other files."""

import random
from collections.abc import Iterator
from functools import partial
from io import BytesIO
from operator import delitem, setitem
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from malformed import Case, good

from microcosmos.archive import creature, creature_h5

ELSEWHERE = "external storage|lie in the file itself|virtual dataset"
hdf5 = partial(Case, kind="application/x-hdf5")

Edits = Iterator[tuple[Any, ...]]
"""The name of a case, a pattern of its refusal, a function of a file, and its arguments."""


def valid_file() -> bytes:
    return creature_h5.dump(creature.parse(good()))


def cases(canary: Path) -> Iterator[Case]:
    """`canary` is a file of this machine that the server must not open."""
    file = valid_file()
    yield from damaged(file)
    for name, says, edit, *arguments in (*outside_links(canary), *bombs(), *wrong_members()):
        stream = BytesIO(file)
        with h5py.File(stream, "r+", libver=("v110", "v110")) as opened:
            edit(opened, *arguments)
        yield hdf5(name, stream.getvalue(), says)


def damaged(file: bytes) -> Iterator[Case]:
    """Files cut off, with bits flipped, and with wrong addresses and lengths."""
    rng = random.Random(11)
    for at in sorted(rng.sample(range(8, len(file) - 1), 120)):
        yield hdf5(f"cut off at {at}", file[:at])
    for at in sorted(rng.sample(range(8, len(file)), 250)):
        flipped = bytearray(file)
        flipped[at] ^= 1 << rng.randrange(8)
        yield hdf5(f"bit flipped in {at}", bytes(flipped), harmless=True)
    for at in range(8, 1200, 8):
        for word in (b"\xff" * 8, b"\0" * 8, at.to_bytes(8, "little")):
            body = file[:at] + word + file[at + 8 :]
            yield hdf5(f"{word.hex()} in {at}", body, harmless=True)
    for size in (8, 64, 4096, 1 << 20):
        yield hdf5(f"{size} bytes before it", bytes(size) + file)
        yield hdf5(f"the first {size} bytes alone", file[:8] + bytes(size))


def members() -> list[str]:
    """The paths of all datasets."""
    names: list[str] = []
    with h5py.File(BytesIO(valid_file())) as file:
        file.visit(names.append)
        return [name for name in names if isinstance(file[name], h5py.Dataset)]


MEMBERS = members()


def outside_links(canary: Path) -> Edits:
    """Members that lie in another file, or under another name, or nowhere."""
    for name in (*MEMBERS, "body", "genome"):
        for title, link in (
            ("external link", h5py.ExternalLink(str(canary), "/identity")),
            ("link to passwords", h5py.ExternalLink("/etc/passwd", "/")),
            ("soft link", h5py.SoftLink("/identity")),
            ("loop of links", h5py.SoftLink(f"/{name}")),
        ):
            yield f"{name}: {title}", ELSEWHERE, replace, name, link
    for name in MEMBERS:
        for path in (str(canary), "/etc/passwd", "/dev/zero", "../" * 12 + str(canary)[1:]):
            yield f"{name}: storage in {path}", ELSEWHERE, store_elsewhere, name, path
        yield f"{name}: virtual", ELSEWHERE, make_virtual, name, str(canary)


def replace(file: h5py.File, name: str, value: Any) -> None:
    del file[name]
    file[name] = value


def store_elsewhere(file: h5py.File, name: str, path: str) -> None:
    """Declare that the data lies in another file, with the same size."""
    shape, dtype = file[name].shape or (1,), file[name].dtype
    size = max(1, int(np.prod(shape))) * dtype.itemsize
    create(file, name, shape=shape, dtype=dtype, external=[(path, 0, size)])


def make_virtual(file: h5py.File, name: str, path: str) -> None:
    dtype = file[name].dtype
    del file[name]
    layout = h5py.VirtualLayout((16,), dtype)
    layout[:] = h5py.VirtualSource(path, "identity", (16,), dtype)
    file.create_virtual_dataset(name, layout)


def create(file: h5py.File, name: str, **options: Any) -> None:
    del file[name]
    file.create_dataset(name, **options)


def bombs() -> Edits:
    """Small files that claim to be large."""
    huge = partial(create, shape=(1 << 40,), dtype="u1")
    growing = partial(create, shape=(0,), maxshape=(None,), chunks=(8,), dtype="f4")
    for name in MEMBERS:
        for title, options in (
            ("zeros in gzip", {"chunks": (1 << 20,), "compression": "gzip"}),
            ("shuffled zeros", {"chunks": (1 << 16,), "compression": "lzf", "shuffle": True}),
            ("tiny chunks", {"chunks": (1,)}),
            ("huge chunks", {"chunks": (1 << 29,)}),
            ("nothing at all", {}),
        ):
            edit = partial(huge, **options)
            yield f"{name}: {title}", "stored plainly|one text|must be", edit, name
        yield f"{name}: growing", "stored plainly", growing, name
    names = list(map("surprise {}".format, range(3000)))
    attributes = dict.fromkeys(names, np.bytes_(b"a" * 50))
    yield "many attributes", "attributes must be", lambda file: file.attrs.update(attributes)
    yield "many groups", "must hold", lambda file: list(map(file.create_group, names))
    yield "deep groups", "must hold", lambda file: file.create_group("/".join("a" * 500))
    yield "a group in itself", "must hold|must be", add_cycle


def add_cycle(file: h5py.File) -> None:
    file["genome/nodes/inside"] = file["genome"]


VALUES = {
    "another type": np.zeros(3, "c16"),
    "a record": np.zeros(2, [("a", "f4"), ("b", "S8")]),
    "text of any length": "text",
    "opaque": np.void(b"12345678"),
    "many": np.zeros(5000, "f4"),
    "NaN": np.float32(np.nan),
    "nothing": h5py.Empty("f4"),
    "enumeration": np.array(1, h5py.enum_dtype({"a": 1})),
}
TEXTS = (b"", b"\xff", b"NaN", b"null ", b"[" * 20_000, b'{"a": 1, "a": 2}', b"0" * 64)


def wrong_members() -> Edits:
    """Members of another kind, with other values, missing, or one too many."""
    for name in MEMBERS:
        for title, value in VALUES.items():
            yield f"{name}: {title}", "", replace, name, value
        yield f"{name} missing", "", delitem, name
        yield f"{name}: a group", "dataset", make_group, name
        yield f"{name} with a bit flipped", "", flip, name
    for name in (*(f"{name}_" for name in MEMBERS), "x", "body/x", "genome/nodes/x"):
        yield f"{name} beside", "must hold", setitem, name, np.zeros(2)
    for name in sorted(creature_h5.ATTRIBUTES):
        texts = {repr(text[:9]): np.bytes_(text) for text in TEXTS}
        for title, value in (VALUES | texts).items():
            new = {name: value}
            yield f"@{name}: {title}", "", lambda file, new=new: file.attrs.update(new)
        yield f"@{name} missing", "attributes must be", lambda file, n=name: file.attrs.pop(n)


def make_group(file: h5py.File, name: str) -> None:
    del file[name]
    file.create_group(name)


def flip(file: h5py.File, name: str) -> None:
    value = np.array(file[name][()])
    raw = bytearray(value.tobytes() or b"\0")
    raw[-1] ^= 0x40
    flipped = np.frombuffer(bytes(raw), value.dtype if value.size else "u1")
    replace(file, name, flipped.reshape(value.shape if value.size else (1,)))
