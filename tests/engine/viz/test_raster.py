"""Still pictures: frames and strips as PNG."""

import io
import sys

import numpy as np
import pytest
from PIL import Image

from microcosmos.optional import require
from microcosmos.viz.film import GAP, LETTERS, moments, png, strip
from microcosmos.viz.raster import THEMES, frame
from microcosmos.viz.replay_file import read_replay

pytestmark = pytest.mark.fast

INK = THEMES["light"].ink
NEUTRAL = THEMES["light"].vorticity[2]
SCALE = 10
"""Pixels a cell of every picture here."""


def shade(picture, x, y):
    """The colour at a point in cells of an unmoved camera."""
    return picture[len(picture) - 1 - int(y * SCALE), int(x * SCALE)].astype(int)


def dark(picture):
    return (np.abs(picture.astype(int) - INK).max(-1) < 8).sum()


@pytest.fixture
def pose(replay_bytes):
    """A function that draws one frame of a body on still fluid of 32 x 24 cells."""

    def draw(positions, edges, levels=None, **options):
        levels = np.zeros((32, 24)) if levels is None else levels
        data = replay_bytes(np.array(positions)[None], edges, levels[None])
        return frame(read_replay(data), 0, width=320, **options)

    return draw


def test_x_goes_right_and_y_goes_up(pose):
    picture = pose([[5.0, 20.0], [9.0, 20.0]], [[0, 1]])
    assert picture.shape == (240, 320, 3)
    for x in (5.0, 7.0, 9.0):
        np.testing.assert_array_equal(shade(picture, x, 20.0), INK)
    for x, y in ((5, 4), (27, 20), (7, 21.5), (3.5, 20)):
        assert np.abs(shade(picture, x, y) - NEUTRAL).max() <= 1


def test_a_straight_filament_on_neutral_fluid_covers_its_length_times_its_width(pose):
    picture = pose([[5.0, 5.0], [6.0, 5.0]], [[0, 1]], way=False)
    still = (np.abs(picture.astype(int) - NEUTRAL).max(-1) == 0).mean()
    assert still > 0.98
    picture = pose([[8.0, 12.0], [20.0, 12.0]], [[0, 1]], way=False)
    radius = 0.4 * SCALE
    area = 12 * SCALE * 2 * radius + np.pi * radius**2
    # A pixel of the rim, which is lighter, is not counted.
    assert area - 2 * 12 * SCALE < dark(picture) <= area


def test_a_filament_across_the_edge_is_seen_on_both_sides(pose):
    inside = pose([[10.0, 12.0], [16.0, 12.0]], [[0, 1]], way=False)
    across = pose([[29.0, 12.0], [35.0, 12.0]], [[0, 1]], way=False)
    for x in (30.0, 31.5, 0.5, 2.5):
        np.testing.assert_array_equal(shade(across, x, 12.0), INK)
    assert np.abs(shade(across, 16, 14) - NEUTRAL).max() <= 1
    assert dark(across) == dark(inside)


@pytest.mark.parametrize("worlds", [(1, 0), (0, -2), (-3, 4)])
def test_a_body_that_has_gone_round_the_box_looks_as_at_home(pose, worlds):
    home = np.array([[10.0, 5.0], [12.0, 7.5], [14.0, 5.0]])
    edges = [[0, 1], [1, 2]]
    away = home + np.array(worlds) * [32, 24]
    np.testing.assert_array_equal(pose(away, edges), pose(home, edges))


def test_a_camera_that_follows_has_the_body_in_the_middle(pose):
    body = np.array([[1.0, 2.0], [3.0, 2.0]])
    followed = pose(body, [[0, 1]], follow=True, way=False)
    np.testing.assert_array_equal(shade(followed, 16.0, 12.0), INK)
    where = np.argwhere(np.abs(followed.astype(int) - INK).max(-1) < 8).mean(0)
    np.testing.assert_allclose(where + 0.5, [120, 160], atol=0.5)


def test_a_curve_runs_round_through_the_nodes_of_a_hexagon(pose):
    turn = 2 * np.pi * np.arange(12) / 12
    circle = np.array([16, 12]) + 5 * np.stack([np.cos(turn), np.sin(turn)], 1)
    picture = pose(circle[::2], [[k, (k + 1) % 6] for k in range(6)])
    # Straight edges would be 0.67 cells inside the circle, more than half the body's width.
    for point in circle:
        np.testing.assert_array_equal(shade(picture, *point), INK)


@pytest.mark.parametrize("theme", THEMES)
def test_opposite_vorticity_has_opposite_colours(pose, theme):
    levels = np.zeros((32, 24))
    levels[5:10, 15:20], levels[20:25, 15:20] = 127, -127
    picture = pose([[16.0, 4.0], [17.0, 4.0]], [[0, 1]], levels, theme=theme)
    ends = THEMES[theme].vorticity
    np.testing.assert_array_equal(shade(picture, 7.05, 17.05), ends[-1])
    np.testing.assert_array_equal(shade(picture, 22.05, 17.05), ends[0])
    np.testing.assert_array_equal(shade(picture, 14.55, 10.05), ends[2])


def test_the_way_is_drawn_from_where_the_creature_began(replay_bytes):
    positions = np.array([[[4.0 + k, 6.0], [5.0 + k, 6.0]] for k in range(20)])
    replay = read_replay(replay_bytes(positions, [[0, 1]], np.zeros((20, 32, 24))))
    with_way, without = (frame(replay, -1, width=320, way=way) for way in (True, False))
    changed = np.argwhere((with_way != without).any(-1))
    assert changed[:, 1].min() == pytest.approx((4.5 - 0.3) * SCALE, abs=1.5)
    assert np.abs(changed[:, 0] + 0.5 - (24 - 6) * SCALE).max() <= 5


def test_each_of_two_creatures_has_its_own_way(replay_bytes):
    positions = np.array([[[4, 4], [6, 4], [20, 10], [22, 10]]] * 2)
    data = replay_bytes(positions, [[0, 1], [2, 3]], np.zeros((2, 32, 24)), member=[0, 0, 1, 1])
    centres = read_replay(data).centres
    np.testing.assert_allclose(centres, [[[5, 4], [21, 10]]] * 2)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"number": 3}, "`number` must be within 3 frames, got 3"),
        ({"number": 0, "width": 321}, "`width` must be an even number of pixels from 16"),
        ({"number": 0, "theme": "grey"}, "`theme` must be one of light, dark, got 'grey'"),
    ],
)
def test_a_picture_that_cannot_be_is_refused(replay_bytes, options, message):
    replay = read_replay(replay_bytes(np.ones((3, 2, 2)), [[0, 1]], np.zeros((3, 8, 8))))
    with pytest.raises(ValueError, match=message):
        frame(replay, options.pop("number"), **options)


def opened(data):
    image = Image.open(io.BytesIO(data))
    assert image.format == "PNG"
    return np.asarray(image.convert("RGB"))


def test_a_png_is_the_frame_itself(swimming):
    picture = opened(png(swimming, 7, width=100, theme="dark"))
    np.testing.assert_array_equal(picture, frame(swimming, 7, width=100, theme="dark"))


@pytest.mark.parametrize("count", [1, 4])
def test_a_strip_has_the_moments_side_by_side(swimming, count):
    sheet = opened(strip(swimming, count, width=64))
    assert sheet.shape[:2] == (48 + 3 * GAP + LETTERS, count * (64 + GAP) + GAP)
    for place, number in enumerate(moments(swimming, count)):
        left = place * (64 + GAP) + GAP
        panel = sheet[GAP : GAP + 48, left : left + 64]
        np.testing.assert_array_equal(panel, frame(swimming, number, width=64))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"count": 0}, "`count` must be from 1 to 31 frames, got 0"),
        ({"count": 32}, "`count` must be from 1 to 31 frames, got 32"),
    ],
)
def test_a_strip_that_cannot_be_is_refused(swimming, options, message):
    with pytest.raises(ValueError, match=message):
        strip(swimming, **options)


def test_a_library_that_is_missing_is_named_with_what_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    reason = r'PIL is needed: pip install "microcosmos\[figures\]"'
    with pytest.raises(ImportError, match=reason):
        require("PIL")
