"""Replays that tests of pictures write themselves."""

import json
import struct

import numpy as np
import pytest

from microcosmos.viz.replay_file import read_replay


@pytest.fixture(scope="session")
def replay_bytes():
    """A function that writes a replay of positions, edges and vorticity levels, all else 0."""

    def write(positions, edges, levels, /, scale=0.01, **change):
        frames, nodes, _ = positions.shape
        header = {
            "format": "microcosmos-replay/2",
            "frames": frames,
            "every": 5,
            "nodes": nodes,
            "edges": edges,
            "joints": [],
            "size": list(levels.shape[1:]),
            "vorticity": {"scale": scale},
            "velocity": {"scale": 1.0},
            "energy": {"scale": 1.0, "frames": 0},
        }
        text = json.dumps(header | change).encode()
        text += b" " * (-len(text) % 4)
        arrays = (
            positions.astype("<f4"),
            np.zeros((frames, len(edges)), "<f4"),
            levels.astype(np.int8),
            np.zeros((frames, 2, *levels.shape[1:]), np.int8),
        )
        return struct.pack("<I", len(text)) + text + b"".join(x.tobytes() for x in arrays)

    return write


@pytest.fixture(scope="session")
def eel(replay_bytes):
    """The bytes of 31 frames of a filament that moves on by a cell a frame through a swirl."""
    t, node = np.arange(31)[:, None], np.arange(10)[None]
    positions = np.stack([10 + node + t, 12 + 2 * np.sin(0.6 * node - 0.5 * t)], -1)
    x, y = np.arange(32)[None, :, None], np.arange(24)[None, None, :]
    swirl = np.cos(2 * np.pi * x / 32) * np.sin(2 * np.pi * y / 24) * t[:, :, None] / 30
    edges = np.stack([node[0, :-1], node[0, 1:]], 1).tolist()
    return replay_bytes(positions, edges, np.round(127 * swirl))


@pytest.fixture(scope="session")
def swimming(eel):
    """The replay of the eel."""
    return read_replay(eel)
