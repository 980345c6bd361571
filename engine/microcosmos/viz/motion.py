"""Motion: a replay made small for pages without a server; see `docs/formats.md`."""

import json
import struct
from typing import Any

import numpy as np

from ..archive.poses import quantised
from .replay_file import Replay

FORMAT = "microcosmos-motion/1"
NUMBERS = 600_000
"""Largest number of coordinates: notebooks are mailed and kept in version control."""
SIDE, LEVELS = 96, 400_000
"""Largest number of squares of the fluid along a side, and over all moments."""
FIELDS = ("nodes", "edges", "size", "solid", "vorticity")


def encode(replay: Replay) -> bytes:
    """Return poses as whole numbers, and the vorticity of fewer moments and larger squares."""
    kept = header(replay)
    positions, middles, scale = quantised(replay.positions[:: stride(replay)])
    last = (kept["frames"] - 1) * stride(replay)
    moments = np.rint(np.linspace(0, last, kept["moments"])).astype(int)
    fluid = means(replay.levels[moments], kept["square"])
    text = json.dumps({"format": FORMAT, **kept, "scale": scale}).encode()
    # Aligned, so that a browser can view the numbers in place.
    text += b" " * (-len(text) % 4)
    arrays = middles.astype("<f4"), positions.astype("<i2"), fluid
    return b"".join((struct.pack("<I", len(text)), text, *(one.tobytes() for one in arrays)))


def header(replay: Replay) -> dict[str, Any]:
    """Return the header of the motion, except the units of its poses."""
    every, width, height = replay.header["every"], *replay.size
    frames = -(-replay.frames // stride(replay))
    square = -(-max(width, height) // SIDE)
    squares = -(-width // square) * -(-height // square)
    return {
        "creature": replay.header.get("creature", ""),
        "frames": frames,
        "every": every * stride(replay),
        "steps": replay.header.get("steps", every * (replay.frames - 1)),
        "moments": min(frames, max(2, LEVELS // squares)),
        "square": square,
        **{name: replay.header[name] for name in FIELDS if name in replay.header},
    }


def stride(replay: Replay) -> int:
    """Return k where every k-th frame is kept."""
    return max(1, -(-replay.positions.size // NUMBERS))


def means(levels: np.ndarray, square: int) -> np.ndarray:
    """Return (moment, x, y) means over squares; those at the end may lack cells."""
    if square == 1:
        return levels
    starts = [np.arange(0, side, square) for side in levels.shape[1:]]
    # In float32, since sums over squares do not fit into int8.
    sums = np.add.reduceat(levels.astype(np.float32), starts[0], axis=1)
    sums = np.add.reduceat(sums, starts[1], axis=2)
    counts = [
        np.diff(one, append=side) for one, side in zip(starts, levels.shape[1:], strict=True)
    ]
    return np.rint(sums / np.outer(*counts)[None]).astype(np.int8)
