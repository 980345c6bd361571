"""The bytes of a replay are read as they were written, and refused where they are not sound."""

import numpy as np
import pytest

from microcosmos.viz.raster import THEMES, frame
from microcosmos.viz.replay import record
from microcosmos.viz.replay_file import Replay, ReplayError, read_replay


def test_a_recorded_replay_is_read_and_drawn(best):
    replay = read_replay(record(best))
    assert replay.header["creature"] == best["sha256"]
    assert (replay.frames, replay.size, replay.step(-1 % replay.frames)) == (41, (32, 32), 40)
    moved = np.linalg.norm(np.diff(replay.centres[[0, -1], 0], axis=0))
    assert moved == pytest.approx(replay.header["fitness"]["replayed"], abs=1e-4)
    assert np.abs(replay.vorticity).max() == pytest.approx(replay.header["vorticity"]["scale"])
    middle = frame(replay, 0, width=320)[160, 160]  # Where the body begins.
    np.testing.assert_array_equal(middle, THEMES["light"].ink)


@pytest.mark.fast
def test_reading_gives_back_what_was_written(replay_bytes):
    random = np.random.default_rng(1)
    positions, levels = random.normal(size=(3, 4, 2)), random.integers(-127, 128, (3, 6, 5))
    replay = read_replay(replay_bytes(positions, [[0, 1]], levels, scale=0.02))
    np.testing.assert_array_equal(replay.positions, positions.astype(np.float32))
    np.testing.assert_allclose(replay.vorticity, levels / 127 * 0.02, rtol=1e-6)
    assert replay.size == (6, 5)


def test_the_strongest_vorticity_leaves_out_one_value_in_a_hundred():
    levels = np.zeros(1000, np.int8)
    levels[:200] = -40
    levels[:2] = 127
    levels[2:5] = 100
    header = {"vorticity": {"scale": 1.27}, "edges": []}
    replay = Replay(header, np.zeros((1, 1, 2)), levels.reshape(1, 10, 100))
    assert replay.strongest == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"format": "microcosmos-replay/9"}, "format"),
        ({"frames": 0}, "frames"),
        ({"every": 1.5}, "every"),
        ({"nodes": None}, "nodes"),
        ({"frames": 3}, "bytes"),
        ({"size": [8]}, "size"),
        ({"edges": [[0, 2]]}, "edges"),
        ({"edges": {}}, "edges"),
        ({"vorticity": {"scale": 0}}, "vorticity.scale"),
        ({"member": [0, 2]}, "member"),
        ({"joints": None}, "joints"),
        ({"joints": [[0, 1]]}, "joints"),
        ({"velocity": {"scale": -1}}, "velocity.scale"),
        ({"energy": []}, "energy"),
        ({"energy": {"scale": 1, "frames": 3}}, "energy.frames"),
        ({"energy": {"scale": None, "frames": 0}}, "energy.scale"),
    ],
)
def test_bytes_that_are_no_replay_are_refused(replay_bytes, change, field):
    data = replay_bytes(np.ones((2, 2, 2)), [[0, 1]], np.zeros((2, 8, 8)), **change)
    with pytest.raises(ReplayError, match="needs") as caught:
        read_replay(data)
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("data", "field"),
    [
        (b"", "bytes"),
        (b"\xff\0\0\0{}", "header"),
        (b"\2\0\0\0{]", "header"),
        (b"\2\0\0\0[]", "header"),
    ],
)
def test_a_header_that_cannot_be_read_is_refused(data, field):
    with pytest.raises(ReplayError) as caught:
        read_replay(data)
    assert caught.value.field == field


def test_positions_that_are_not_finite_are_refused(replay_bytes):
    data = replay_bytes(np.full((1, 2, 2), np.nan), [[0, 1]], np.zeros((1, 8, 8)))
    with pytest.raises(ReplayError, match="`positions` needs finite numbers"):
        read_replay(data)
