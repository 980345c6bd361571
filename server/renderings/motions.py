"""The motion within a replay, without the fluid: little enough for a wall of creatures."""

import json
import struct
from collections.abc import Iterable
from typing import Any

from ..storage.artifacts import Artifacts
from ..tables import Artifact

FORMAT = "microcosmos-motion/1"
FRAMES = 96
"""At most so many; a wall shows no more."""
COPIED = ("creature", "steps", "nodes", "edges", "member", "size")
LENGTH = struct.Struct("<I")
POSITION = 2 * 4
"""Bytes of the float32 coordinates of a node."""


def motion(artifacts: Artifacts, replay: Artifact) -> bytes:
    """A JSON header behind its length, then float32 positions of every k-th recorded frame."""
    (length,) = LENGTH.unpack(_part(artifacts, replay, 0, LENGTH.size))
    start = LENGTH.size + length
    header = json.loads(_part(artifacts, replay, LENGTH.size, start))
    frame = header["nodes"] * POSITION
    positions = _part(artifacts, replay, start, start + header["frames"] * frame)
    stride = -(-header["frames"] // FRAMES)
    kept = range(0, header["frames"], stride)
    told = json.dumps(_header(header, stride, len(kept))).encode()
    pieces: Iterable[bytes] = (positions[i * frame : (i + 1) * frame] for i in kept)
    return b"".join((LENGTH.pack(len(told)), told, *pieces))


def _header(header: dict[str, Any], stride: int, frames: int) -> dict[str, Any]:
    copied = {name: header[name] for name in COPIED if name in header}
    return {"format": FORMAT, **copied, "frames": frames, "every": header["every"] * stride}


def _part(artifacts: Artifacts, replay: Artifact, start: int, stop: int) -> bytes:
    return b"".join(artifacts.stream(replay.path, start, stop))
