"""Film strips turn the way of a stroke upwards and keep the body's shape."""

import numpy as np
import pytest
from pose_streams import stream

from microcosmos.archive.poses import FRAMES
from microcosmos.viz.figures.strips import strip

LENGTH = 5.0


def swimming(way, strokes=2):
    """A pose stream: a body opens and closes while it moves by `way` in two strokes."""
    time = np.arange(1, FRAMES + 1) / FRAMES
    opened = 2 + np.cos(4 * np.pi * time)
    body = np.stack([np.outer(opened, [-1, 0, 1]), np.outer(opened, [0, 1, 0])], 2)
    return stream(body + time[:, None, None] * np.array(way), LENGTH, strokes=strokes)


@pytest.mark.parametrize("degrees", [0, 60, 200])
def test_the_way_of_a_stroke_is_upwards(degrees):
    angle = np.radians(degrees)
    found = strip(0.3, swimming(10 * np.array([np.cos(angle), np.sin(angle)])))
    assert found.fitness == 0.3
    assert found.advance == pytest.approx(5 / LENGTH, abs=1e-3)
    np.testing.assert_allclose(found.poses.mean(1), 0, atol=1e-6)
    sides = np.linalg.norm(np.diff(found.poses, axis=1), axis=2) * LENGTH
    opened = 2 + np.cos(4 * np.pi * np.arange(FRAMES // 2, FRAMES + 1) / FRAMES)
    np.testing.assert_allclose(sides, np.sqrt(2) * opened[:, None] * [1, 1], atol=2e-3)
    # Before it is turned, the way points along (cos, sin) and the body's chord along x.
    chord = found.poses[0, 2] - found.poses[0, 0]
    turned = np.array([np.sin(angle), np.cos(angle)])
    np.testing.assert_allclose(chord / np.linalg.norm(chord), turned, atol=2e-3)


def test_without_two_strokes_all_frames_are_shown():
    assert len(strip(0, swimming((1.0, 0.0), strokes=0)).poses) == FRAMES
