"""Pose streams that tests make up."""

import numpy as np

from microcosmos.archive.poses import MOMENTS, PoseStream, decode, quantised


def stream(positions, length, edges=None, strokes=2):
    """A pose stream of positions (frame, node, 2), of a chain unless there are edges."""
    units, middles, scale = quantised(positions)
    nodes = np.arange(positions.shape[1])
    return PoseStream(
        positions=units,
        path=np.zeros((MOMENTS, 2), np.float32),
        middles=middles,
        scale=scale,
        edges=np.stack([nodes[:-1], nodes[1:]], 1) if edges is None else np.array(edges),
        start=0,
        stop=400,
        strokes=strokes,
        steps=400,
        size=(64, 64),
        length=length,
        creature="",
    )


def unpacked(content: bytes) -> list[PoseStream]:
    """The streams of a batch, each of which follows its length."""
    found = []
    while content:
        stop = 4 + int.from_bytes(content[:4], "little")
        found.append(decode(content[4:stop]))
        content = content[stop:]
    return found
