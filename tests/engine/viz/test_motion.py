"""A motion is a replay made small."""

import json
import struct

import numpy as np
import pytest

from microcosmos.viz import motion
from microcosmos.viz.replay_file import read_motion, read_replay


@pytest.fixture
def recorded(replay_bytes):
    """A function that makes a replay of a body that drifts, in a fluid whose levels grow."""

    def make(frames, nodes, size):
        places = np.linspace(0, 50, 2 * frames * nodes).reshape(frames, nodes, 2)
        levels = np.zeros((frames, *size), np.int8) + np.arange(size[0])[:, None].clip(0, 100)
        edges = [[k, k + 1] for k in range(nodes - 1)]
        return replay_bytes(places.astype("<f4"), edges, levels.astype(np.int8), steps=99)

    return make


def parts(data):
    """The header of a motion, its places in cells, and its levels."""
    (length,) = struct.unpack_from("<I", data)
    header = json.loads(data[4 : 4 + length])
    frames, nodes, square = (header[name] for name in ("frames", "nodes", "square"))
    middles = np.frombuffer(data, "<f4", 2 * frames, 4 + length).reshape(frames, 1, 2)
    units = np.frombuffer(data, "<i2", 2 * frames * nodes, 4 + length + middles.nbytes)
    shape = header["moments"], *(-(-side // square) for side in header["size"])
    levels = np.frombuffer(
        data, np.int8, offset=4 + length + middles.nbytes + units.nbytes
    ).reshape(shape)
    places = middles + header["scale"] * units.reshape(frames, nodes, 2)
    return header, places, levels


def test_a_small_replay_is_kept(recorded):
    replay = read_replay(recorded(7, 4, (12, 8)))
    header, places, levels = parts(motion.encode(replay))
    assert (header["frames"], header["every"], header["steps"]) == (7, 5, 99)
    np.testing.assert_allclose(places, replay.positions, atol=50 / 2**16)
    np.testing.assert_array_equal(levels, replay.levels)


def test_a_large_fluid_has_means_over_squares_and_fewer_moments(recorded):
    replay = read_replay(recorded(250, 4, (200, 97)))
    header, places, levels = parts(motion.encode(replay))
    assert (header["square"], header["frames"], len(places)) == (3, 250, 250)
    assert levels.shape == (motion.LEVELS // (67 * 33), 67, 33)
    np.testing.assert_array_equal(levels[0, :33, 0], 3 * np.arange(33) + 1)
    assert levels[-1, -1, -1] == 100, "squares at the end may lack cells"


def test_a_long_motion_of_many_nodes_keeps_every_kth_frame(recorded, monkeypatch):
    monkeypatch.setattr(motion, "NUMBERS", 100)
    replay = read_replay(recorded(21, 10, (8, 8)))
    header, places, _ = parts(motion.encode(replay))
    assert (header["frames"], header["every"]) == (5, 25)
    np.testing.assert_allclose(places, replay.positions[::5], atol=50 / 2**16)


def test_a_motion_is_read_from_the_beginning_of_a_replay(recorded):
    data = recorded(7, 4, (12, 8))
    asked = []

    def part(start, stop):
        asked.append(stop)
        return data[start:stop]

    replay, whole = read_motion(part), read_replay(data)
    assert replay.drive is None
    np.testing.assert_array_equal(replay.positions, whole.positions)
    np.testing.assert_array_equal(replay.levels, whole.levels)
    assert max(asked) < len(data) / 2
