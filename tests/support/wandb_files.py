"""A reader of W&B's offline files, for tests: LevelDB's log format around W&B's own messages.

W&B 0.31 reads them in its Go program alone; its older Python reader (0.22) finds the same.
"""

import json
import struct
from pathlib import Path

from wandb.proto.wandb_internal_pb2 import Record

BLOCK, HEADER, IDENT = 32_768, 7, 7
FULL, FIRST, LAST = 1, 2, 4


def records(file: Path):
    """Yield the records of a file; raises `ValueError` where it is malformed."""
    data, place, parts = file.read_bytes(), IDENT, []
    if not data.startswith(b":W&B"):
        raise ValueError(f"{file} must begin with :W&B, got {data[:4]!r}")
    while place + HEADER <= len(data):
        if BLOCK - place % BLOCK < HEADER:  # The rest of a block is padding.
            place += BLOCK - place % BLOCK
            continue
        _, length, kind = struct.unpack_from("<IHB", data, place)
        place += HEADER
        parts = [] if kind in (FULL, FIRST) else parts
        parts.append(data[place : place + length])
        place += length
        if kind in (FULL, LAST):
            found = Record()
            found.ParseFromString(b"".join(parts))
            yield found


def row(record: Record) -> dict:
    """Return the values of a row of the history by their names."""
    return {
        item.key or "/".join(item.nested_key): json.loads(item.value_json)
        for item in record.history.item
    }


def names(artifact) -> list[str]:
    """Return the paths of the files of an artifact."""
    return [entry.path for entry in artifact.manifest.contents]
