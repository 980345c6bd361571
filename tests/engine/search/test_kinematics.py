"""Waves, beats, axis and excursion against closed forms, and the window of recorded poses."""

import jax
import numpy as np
import pytest

from microcosmos.archive.poses import FRAMES
from microcosmos.device import array
from microcosmos.search import measures
from microcosmos.search.window import poses
from microcosmos.search.window import window as window_of

axis, excursion, waves, window = map(
    jax.jit, (measures.axis, measures.excursion, measures.waves, window_of)
)
pytestmark = pytest.mark.fast

TIMES = 2 * np.pi * np.arange(FRAMES)[:, None] / (FRAMES // 2)
"""The phase of every frame, in rad; the frames span two strokes."""
PLACES = np.arange(21)[None]
CHAIN = np.ones(20, bool)


def measured(bends, along=CHAIN):
    return [float(x) for x in waves(bends, along)]


@pytest.mark.parametrize("beats", [0.5, 1, 3])
@pytest.mark.parametrize("number", [0.02, 0.1, 0.3])
def test_a_travelling_wave(float64, beats, number):
    wave = 0.4 + 0.2 * np.sin(beats * TIMES - 2 * np.pi * number * PLACES)
    assert measured(wave) == pytest.approx([beats, number, 1])
    assert measured(wave[:, ::-1]) == pytest.approx([beats, number, -1])


def test_a_standing_wave_travels_nowhere(float64):
    """Over whole waves, the rms slope of a standing wave is that of a travelling one."""
    wave = np.sin(TIMES) * np.sin(2 * np.pi * (PLACES + 0.5) / 20)
    beats, number, direction = measured(wave)
    assert beats == pytest.approx(1)
    assert number == pytest.approx(1 / 20)
    assert direction == pytest.approx(0, abs=1e-12)


def test_joints_of_different_filaments_are_not_neighbours(float64):
    """Two filaments whose waves are in opposite phase where they meet."""
    wave = np.sin(TIMES - 2 * np.pi * 0.1 * np.arange(10)[None])
    along = np.arange(19) != 9
    assert measured(np.concatenate([wave, -wave], 1), along) == pytest.approx([1, 0.1, 1])


def frames(shape):
    return np.broadcast_to(shape, (FRAMES, *np.shape(shape)))


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0, -1.2])
@pytest.mark.parametrize("course", [0.0, 0.3, np.pi / 2])
def test_the_axis_of_a_cross(float64, turn, course):
    """Arms of lengths 4 and 1 along the axes: second moments 32 and 2."""
    points = np.array([[4, 0], [-4, 0], [0, 1], [0, -1]]) + np.array([7.0, 3.0])
    c, s = np.cos(turn), np.sin(turn)
    points = points @ np.array([[c, s], [-s, c]])
    moved = 5 * np.array([np.cos(turn + course), np.sin(turn + course)])
    angle, aspect = axis(frames(points), moved, None)
    assert float(angle) == pytest.approx(course, abs=1e-6)
    assert float(aspect) == pytest.approx(0.25)


def test_absent_nodes_count_nowhere(float64):
    points = np.array([[4.0, 0], [-4, 0], [0, 1], [0, -1], [90, 90]])
    kept = np.arange(5) < 4
    moved = np.array([1.0, 0.0])
    assert [float(x) for x in axis(frames(points), moved, kept)] == pytest.approx([0, 0.25])
    assert float(excursion(frames(points), moved, kept)) == 0


def test_the_excursion_is_across_the_path(float64):
    """One node of two swings 3 cells up and down, and their mean half as much."""
    swing = np.zeros((FRAMES, 2, 2))
    swing[:, 1, 1] = 3 * np.sin(TIMES[:, 0])
    found = excursion(swing, np.array([2.0, 0.0]), None)
    assert float(found) == pytest.approx(3)
    assert float(excursion(swing, np.array([0.0, 2.0]), None)) == 0


@pytest.mark.parametrize(
    ("strokes", "expected"),
    [
        (np.arange(1, 1001) / 200, (600, 1000, 2)),
        (np.arange(1, 1001) / 300, (300, 900, 2)),
        (np.arange(1, 1001) / 500, (0, 1000, 2)),
        (np.arange(1, 1001) / 501, (0, 1000, 0)),
        (np.zeros(1000), (0, 1000, 0)),
        # Strokes end at 62.5 and 87.5 steps: halves are rounded up, as in the kernel.
        (np.arange(1, 96) / 12.5, (63, 88, 2)),
        # The clock slows after the first stroke.
        (np.interp(np.arange(1, 1001), [0, 100, 1000], [0, 1, 3]), (100, 1000, 2)),
    ],
)
def test_the_window_is_the_last_two_whole_strokes(float64, strokes, expected):
    found = window(strokes)
    assert (int(found.start), int(found.stop), int(found.strokes)) == expected
    steps = np.asarray(found.places()) + 1
    assert steps[-1] == found.stop
    exact = found.start + np.arange(1, FRAMES + 1) / FRAMES * (found.stop - found.start)
    assert np.abs(steps - exact).max() <= 0.5


def test_poses_are_the_positions_at_those_steps(float64):
    random = np.random.default_rng(0)
    positions = 20 + random.normal(size=(300, 5, 2))
    centre, kept = positions.mean(1), np.arange(5) != 3
    last = window(np.arange(1.0, 301) / 100)
    none = np.zeros((0, 2), int)
    at = np.asarray(last.places())
    path = np.concatenate([np.zeros((1, 2)), centre])
    corners = np.cumsum(random.integers(-40, 40, (FRAMES, 2)), 0).astype(float)
    given = path, positions[at], corners, kept, none, last, array(4.0)
    found = jax.jit(poses)(*given)
    offsets = np.asarray(found.scale) * np.asarray(found.positions)
    cells = np.asarray(found.middles)[:, None] + offsets
    shown = positions[at] + corners[:, None]
    np.testing.assert_allclose(cells[:, kept], shown[:, kept], atol=float(found.scale))
    assert float(found.scale) < 2e-4
    np.testing.assert_array_equal(found.path[0], 0)
    np.testing.assert_array_equal(
        np.asarray(found.path)[[32, 64]], np.asarray(centre)[[149, 299]]
    )
