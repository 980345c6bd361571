"""Malformed HDF5 files of creatures, and some that refer to other files."""

import random
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from malformed import Case, good

from microcosmos.archive import creature, creature_h5

HDF5 = "application/x-hdf5"
ELSEWHERE = "external storage|lie in the file itself|virtual dataset"
HUGE = (1 << 40,)

Edit = Callable[[h5py.File], None]


def whole() -> bytes:
    return creature_h5.dump(creature.parse(good()))


def cases(canary: Path) -> Iterator[Case]:
    """`canary` is a file of this machine that the server must not open."""
    file = whole()
    yield from damaged(file)
    for name, edit, says in (*foreign(canary), *bombs(), *others()):
        yield Case(name, edited(file, edit), says, HDF5)


def damaged(file: bytes) -> Iterator[Case]:
    """Files cut off, with bits flipped, and with wrong addresses and lengths."""
    chance = random.Random(11)
    for at in sorted(chance.sample(range(8, len(file) - 1), 120)):
        yield Case(f"cut off at {at}", file[:at], "", HDF5)
    for at in sorted(chance.sample(range(8, len(file)), 250)):
        flipped = bytearray(file)
        flipped[at] ^= 1 << chance.randrange(8)
        yield Case(f"turned over in {at}", bytes(flipped), "", HDF5, harmless=True)
    for at in range(8, 1200, 8):
        for word in (b"\xff" * 8, b"\0" * 8, at.to_bytes(8, "little")):
            body = file[:at] + word + file[at + 8 :]
            yield Case(f"{word.hex()} in {at}", body, "", HDF5, harmless=True)
    for size in (8, 64, 4096, 1 << 20):
        yield Case(f"{size} bytes before it", bytes(size) + file, "", HDF5)
        yield Case(f"the first {size} bytes alone", file[:8] + bytes(size), "", HDF5)


def edited(file: bytes, edit: Edit) -> bytes:
    stream = BytesIO(file)
    with h5py.File(stream, "r+", libver=("v110", "v110")) as found:
        edit(found)
    return stream.getvalue()


def members(file: bytes) -> list[str]:
    names: list[str] = []
    with h5py.File(BytesIO(file), "r") as opened:
        opened.visit(names.append)
        return [name for name in names if isinstance(opened[name], h5py.Dataset)]


MEMBERS = members(whole())
Edits = Iterator[tuple[str, Edit, str]]


def foreign(canary: Path) -> Edits:
    """Members that lie in another file, or under another name, or nowhere."""
    for name in (*MEMBERS, "body", "genome"):
        for title, link in (
            ("external link", h5py.ExternalLink(str(canary), "/identity")),
            ("link to passwords", h5py.ExternalLink("/etc/passwd", "/")),
            ("soft link", h5py.SoftLink("/identity")),
            ("loop of links", h5py.SoftLink(f"/{name}")),
        ):
            yield f"{name}: {title}", replacing(name, link), ELSEWHERE
    for name in MEMBERS:
        for path in (str(canary), "/etc/passwd", "/dev/zero", "../" * 12 + str(canary)[1:]):
            yield f"{name}: storage in {path}", stored(name, path), ELSEWHERE
        yield f"{name}: virtual", virtual(name, str(canary)), ELSEWHERE


def replacing(name: str, value: Any) -> Edit:
    def edit(file: h5py.File) -> None:
        del file[name]
        file[name] = value

    return edit


def stored(name: str, path: str) -> Edit:
    """As large as it was, with its bytes in another file."""

    def edit(file: h5py.File) -> None:
        shape, dtype = file[name].shape or (1,), file[name].dtype
        size = max(1, int(np.prod(shape))) * dtype.itemsize
        del file[name]
        file.create_dataset(name, shape, dtype, external=[(path, 0, size)])

    return edit


def virtual(name: str, path: str) -> Edit:
    def edit(file: h5py.File) -> None:
        dtype = file[name].dtype
        del file[name]
        layout = h5py.VirtualLayout((16,), dtype)
        layout[:] = h5py.VirtualSource(path, "identity", (16,), dtype)
        file.create_virtual_dataset(name, layout)

    return edit


def bombs() -> Edits:
    """Small files that claim to be large."""
    for name in MEMBERS:
        for title, options in (
            ("zeros in gzip", {"chunks": (1 << 20,), "compression": "gzip"}),
            ("shuffled zeros", {"chunks": (1 << 16,), "compression": "lzf", "shuffle": True}),
            ("tiny chunks", {"chunks": (1,)}),
            ("huge chunks", {"chunks": (1 << 29,)}),
            ("nothing at all", {}),
        ):
            edit = made(name, shape=HUGE, dtype="u1", **options)
            yield f"{name}: {title}", edit, "stored plainly|one text|must be"
        many = {"shape": (0,), "maxshape": (None,), "chunks": (8,), "dtype": "f4"}
        yield f"{name}: growing", made(name, **many), "stored plainly"
    yield "many attributes", lambda file: with_attributes(file, 3000), "attributes must be"
    yield "many groups", lambda file: with_groups(file, 3000), "must hold"
    yield "deep groups", lambda file: deep(file, 500), "must hold"
    yield "a group in itself", cycle, "must hold|must be"


def made(name: str, **options: Any) -> Edit:
    def edit(file: h5py.File) -> None:
        del file[name]
        file.create_dataset(name, **options)

    return edit


def with_attributes(file: h5py.File, count: int) -> None:
    for number in range(count):
        file.attrs[f"surprise {number}"] = np.bytes_(b"a" * 50)


def with_groups(file: h5py.File, count: int) -> None:
    for number in range(count):
        file.create_group(f"surprise {number}")


def deep(file: h5py.File, levels: int) -> None:
    group = file
    for _ in range(levels):
        group = group.create_group("a")


def cycle(file: h5py.File) -> None:
    file["genome/nodes/inside"] = file["genome"]


def others() -> Edits:
    """Members of another kind, with other values, missing, or one too many."""
    values = {
        "another type": np.zeros(3, "c16"),
        "a record": np.zeros(2, [("a", "f4"), ("b", "S8")]),
        "text of any length": "text",
        "opaque": np.void(b"12345678"),
        "many": np.zeros(5000, "f4"),
        "NaN": np.float32(np.nan),
        "nothing": h5py.Empty("f4"),
        "enumeration": np.array(1, h5py.enum_dtype({"a": 1})),
    }
    for name in MEMBERS:
        for title, value in values.items():
            yield f"{name}: {title}", replacing(name, value), ""
        yield f"{name} missing", lambda file, name=name: file.pop(name), ""
        yield f"{name}: a group", lambda file, name=name: grouped(file, name), "dataset"
        yield f"{name} turned round", lambda file, name=name: negated(file, name), ""
    for name in (*MEMBERS, "x", "body/x", "genome/nodes/x"):
        yield f"{name} beside", lambda file, name=name: beside(file, name), "must hold"
    for name in creature_h5.ATTRIBUTES:
        for title, value in values.items():
            yield f"@{name}: {title}", with_attribute(name, value), ""
        texts = (b"", b"\xff", b"NaN", b"null ", b"[" * 20_000, b'{"a": 1, "a": 2}', b"0" * 64)
        for text in texts:
            yield f"@{name}: {text[:9]!r}", with_attribute(name, np.bytes_(text)), ""
        yield f"@{name} missing", lambda file, n=name: file.attrs.pop(n), "attributes must be"


def grouped(file: h5py.File, name: str) -> None:
    del file[name]
    file.create_group(name)


def negated(file: h5py.File, name: str) -> None:
    value = np.array(file[name][()])
    raw = bytearray(value.tobytes() or b"\0")
    raw[-1] ^= 0x40
    del file[name]
    turned = np.frombuffer(bytes(raw), value.dtype if value.size else "u1")
    file[name] = turned.reshape(value.shape if value.size else (1,))


def beside(file: h5py.File, name: str) -> None:
    file[f"{name}_" if name in MEMBERS else name] = np.zeros(2)


def with_attribute(name: str, value: Any) -> Edit:
    def edit(file: h5py.File) -> None:
        del file.attrs[name]
        file.attrs[name] = value

    return edit
