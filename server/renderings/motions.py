"""The motion within a replay, without the fluid: small enough for a gallery of creatures."""

import json
import struct

from ..storage.artifacts import Artifacts
from ..tables import Artifact

FORMAT = "microcosmos-motion/1"
FRAMES = 96
"""Limit on frames; a gallery shows no more."""
COPIED = ("creature", "steps", "nodes", "edges", "member", "size")
LENGTH = struct.Struct("<I")
POSITION_BYTES = 2 * 4
"""Bytes of the float32 coordinates of a node."""


def motion(artifacts: Artifacts, replay: Artifact) -> bytes:
    """Return the length of a JSON header, the header, and every k-th frame of positions.

    Positions are float32.
    """
    (length,) = LENGTH.unpack(_part(artifacts, replay, 0, LENGTH.size))
    start = LENGTH.size + length
    header = json.loads(_part(artifacts, replay, LENGTH.size, start))
    frame = header["nodes"] * POSITION_BYTES
    positions = _part(artifacts, replay, start, start + header["frames"] * frame)
    stride = -(-header["frames"] // FRAMES)
    kept = range(0, header["frames"], stride)
    copied = {name: header[name] for name in COPIED if name in header}
    every = header["every"] * stride
    shorter = {"format": FORMAT, **copied, "frames": len(kept), "every": every}
    encoded = json.dumps(shorter).encode()
    pieces = (positions[i * frame : (i + 1) * frame] for i in kept)
    return b"".join((LENGTH.pack(len(encoded)), encoded, *pieces))


def _part(artifacts: Artifacts, replay: Artifact, start: int, stop: int) -> bytes:
    return b"".join(artifacts.stream(replay.path, start, stop))
