"""The replay of a made-up swimmer."""

import numpy as np
import pytest

from microcosmos.viz.replay_file import read_replay


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
    return read_replay(eel)
