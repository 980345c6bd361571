"""Checkpoints in segments: append-only data of a run is written once.

In a long run, most of a file is columns that only grow, such as the lineage. They are cut into
pieces of one size, and a full piece is a segment: a file of its own, which later checkpoints
name too. The head of a checkpoint names its segments and holds all other bytes. Head and
segments together are the whole file, byte for byte.
"""

import json
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import PurePosixPath
from typing import Any, NamedTuple

from microcosmos.archive import file

from ..core.errors import FileLost
from ..tables import Artifact
from .artifacts import Artifacts, StoredFile

FORMAT = "microcosmos-checkpoint/1"
# It is read and converted in memory.
LARGEST = 200_000_000
"""Bytes of a run's file that the server converts. People may download and export any."""
VERIFIED = 8
"""Segments that each save reads again. All later checkpoints name a segment, so one that rots
on its disk must be found while a run still has its bytes."""
_LENGTH = struct.Struct("<I")


class Damaged(Exception):
    """A file that the database names is missing from the store, or has changed."""

    def __init__(self, path: str, *, missing: bool):
        super().__init__(path)
        self.path, self.missing = path, missing


@dataclass
class Segments:
    """The segments of a run that an attempt knows to be stored and intact."""

    growing: tuple[str, ...] = ()
    """Groups of the file whose rows are only ever appended."""
    stored: dict[str, StoredFile] = field(default_factory=dict)
    """Stored segments by SHA-256, those of the restored checkpoint among them, in the order in
    which they are verified."""
    recorded: set[str] = field(default_factory=set)
    """Paths of those that the database names."""

    def begin_from(self, stored: Mapping[str, StoredFile]) -> None:
        """Take over the segments of a checkpoint, which are recorded."""
        self.stored = dict(stored)
        self.recorded = {one.path for one in stored.values()}


class Written(NamedTuple):
    """The file of a checkpoint in the store: a head, or the whole file without segments."""

    file: StoredFile
    whole: StoredFile | None = None
    """Size and hash of the undivided file. Nothing is stored at its path."""
    new: tuple[StoredFile, ...] = ()
    """Segments that the database does not name yet."""


class Piece(NamedTuple):
    """Some bytes of a whole file, and where they are stored."""

    start: int
    stop: int
    path: str
    offset: int


def write(store: Artifacts, path: str, data: bytes, known: Segments, size: int) -> Written:
    """Write the segments of a size that are new, then the head.

    Raise what `Artifacts.write` does.

    Paths begin with that of the whole file, which is used once: a file that is marked for
    deletion is never one that was written again.
    """
    stem = path.removesuffix(".h5")
    places = _full_pieces(data, known.growing, size) if known.growing else []
    if not places:
        return Written(store.write(path, data))
    _forget_lost(store, known)
    named: list[tuple[int, StoredFile]] = []
    rest, end = [], 0
    for start in places:
        piece = data[start : start + size]
        digest = sha256(piece).hexdigest()
        if digest not in known.stored:
            known.stored[digest] = store.write(f"{stem}-{len(named)}.segment", piece)
        named.append((start, known.stored[digest]))
        rest.append(data[end:start])
        end = start + size
    rest.append(data[end:])
    whole = StoredFile(path, len(data), sha256(data).hexdigest())
    header = {
        "format": FORMAT,
        "size": whole.size,
        # Their names alone: all files of a run are in one folder.
        "segments": [
            (start, one.size, PurePosixPath(one.path).name, one.sha256) for start, one in named
        ],
    }
    text = json.dumps(header, separators=(",", ":")).encode()
    head = b"".join((_LENGTH.pack(len(text)), text, *rest))
    written = store.write(f"{stem}-{sha256(head).hexdigest()[:8]}.head", head)
    new = {one.path: one for _, one in named if one.path not in known.recorded}
    return Written(written, whole, tuple(new.values()))


def _full_pieces(data: bytes, growing: Sequence[str], size: int) -> list[int]:
    """Return the start of each full piece, except one that ends a column.

    The last row may yet change: a run that is extended computes some of it again.
    """
    columns = file.extents(data, growing)
    return [at for start, stop in columns for at in range(start, stop - size, size)]


def _forget_lost(store: Artifacts, known: Segments) -> None:
    """Forget segments that are gone or damaged: this checkpoint writes them again.

    All sizes are compared; some segments in turn are read.
    """
    sizes = store.sizes([one.path for one in known.stored.values()])
    lost = {digest for digest, one in known.stored.items() if sizes.get(one.path) != one.size}
    intact = [digest for digest in known.stored if digest not in lost]
    for digest in intact[:VERIFIED]:
        one = known.stored.pop(digest)
        if store.read_verified(one.path, digest) is None:
            lost.add(digest)
        known.stored[digest] = one  # The last in turn now.
    for digest in lost:
        known.recorded.discard(known.stored.pop(digest).path)


def whole(row: Artifact) -> StoredFile:
    """Return the file that a row stands for; `path` is that of its head, if it has one."""
    if row.whole_sha256 is None or row.whole_size is None:
        return StoredFile(row.path, row.size, row.sha256)
    return StoredFile(row.path, row.whole_size, row.whole_sha256)


def read(store: Artifacts, row: Artifact) -> bytes:
    """Return the whole file. Raise `FileLost` if a part is missing or has changed."""
    try:
        return read_intact(store, row)[0]
    except Damaged as error:
        raise FileLost(error.path) from error


def read_intact(store: Artifacts, row: Artifact) -> tuple[bytes, dict[str, StoredFile]]:
    """Return the whole file, verified, and its segments by SHA-256. Raise `Damaged`."""
    data = _intact(store, StoredFile(row.path, row.size, row.sha256))
    if row.whole_sha256 is None:
        return data, {}
    header, offset = _header(data)
    segments = {
        digest: StoredFile(_beside(row.path, name), size, digest)
        for _, size, name, digest in header["segments"]
    }
    contents = {one.path: _intact(store, one) for one in segments.values()}
    contents[row.path] = data
    pieces = _pieces(row.path, header, offset)
    joined = b"".join(
        contents[one.path][one.offset : one.offset + one.stop - one.start] for one in pieces
    )
    if sha256(joined).hexdigest() != row.whole_sha256:
        raise Damaged(row.path, missing=False)
    return joined, segments


def stream(store: Artifacts, row: Artifact, start: int, stop: int) -> Iterator[bytes]:
    """Return the bytes from `start` up to `stop` in pieces; read the first at once."""
    if row.whole_sha256 is None:
        return store.stream(row.path, start, stop)
    (length,) = _LENGTH.unpack(store.read(row.path, 0, _LENGTH.size))
    header = json.loads(store.read(row.path, _LENGTH.size, _LENGTH.size + length))

    def contents() -> Iterator[bytes]:
        for one in _pieces(row.path, header, _LENGTH.size + length):
            first, end = max(start, one.start), min(stop, one.stop)
            if first < end:
                shift = one.offset - one.start
                yield from store.stream(one.path, first + shift, end + shift)

    found = contents()
    begin = next(found, b"")

    def all_contents() -> Iterator[bytes]:
        yield begin
        yield from found

    return all_contents()


def _intact(store: Artifacts, one: StoredFile) -> bytes:
    try:
        data = store.read(one.path)
    except FileLost:
        raise Damaged(one.path, missing=True) from None
    if sha256(data).hexdigest() != one.sha256:
        raise Damaged(one.path, missing=False)
    return data


def _header(head: bytes) -> tuple[dict[str, Any], int]:
    """Return the header of a head, and the place of the bytes that follow it."""
    (length,) = _LENGTH.unpack_from(head)
    end = _LENGTH.size + length
    return json.loads(head[_LENGTH.size : end]), end


def _beside(head: str, name: str) -> str:
    return str(PurePosixPath(head).with_name(name))


def _pieces(head: str, header: dict[str, Any], offset: int) -> Iterator[Piece]:
    """Yield the pieces of a whole file in order."""
    end = 0
    for start, size, name, _ in header["segments"]:
        if end < start:
            yield Piece(end, start, head, offset)
            offset += start - end
        end = start + size
        yield Piece(start, end, _beside(head, name), 0)
    if end < header["size"]:
        yield Piece(end, header["size"], head, offset)
