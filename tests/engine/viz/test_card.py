"""Cards for other sites: a picture, and a film that ends as it begins."""

import io

import av
import numpy as np
import pytest
from PIL import Image

from microcosmos.viz.film import FILM, MOMENT, PICTURE, RATE, loop, loop_frames, preview
from microcosmos.viz.raster import THEMES, frame
from microcosmos.viz.replay_file import read_replay

WIDTH, HEIGHT = PICTURE
ABOVE_THE_BAR = slice(0, HEIGHT - 70)
PERIOD = 25


@pytest.fixture(scope="module")
def beating(replay_bytes):
    """A filament that beats once in 25 frames."""
    t, node = np.arange(101)[:, None], np.arange(10)[None]
    wave = 2 * np.sin(0.6 * node - 2 * np.pi * t / PERIOD)
    positions = np.stack([10 + node + 0.1 * t, 12 + wave], -1)
    edges = np.stack([node[0, :-1], node[0, 1:]], 1).tolist()
    return read_replay(replay_bytes(positions, edges, np.zeros((101, 32, 24))))


def opened(data):
    return np.asarray(Image.open(io.BytesIO(data)))


@pytest.mark.long
@pytest.mark.parametrize("theme", list(THEMES))
def test_a_preview_is_the_middle_of_a_frame_that_follows_the_creature(swimming, theme):
    picture = opened(preview(swimming, theme))
    assert picture.shape == (HEIGHT, WIDTH, 3)
    number = round(MOMENT * (swimming.frames - 1))
    whole = frame(swimming, number, width=WIDTH, theme=theme, follow=True)
    above = (len(whole) - HEIGHT) // 2
    middle = whole[above : above + HEIGHT]
    np.testing.assert_array_equal(picture[ABOVE_THE_BAR], middle[ABOVE_THE_BAR])


def test_a_loop_ends_where_it_begins(beating):
    numbers = loop_frames(beating)
    assert len(numbers) % PERIOD == 0
    assert numbers[-1] == 100
    shapes = beating.positions - beating.positions.mean(1, keepdims=True)
    np.testing.assert_allclose(shapes[numbers[0] - 1], shapes[100], atol=1e-4)


@pytest.mark.long
def test_the_film_repeats_the_loop_for_some_seconds(beating):
    with av.open(io.BytesIO(loop(beating))) as container:
        stream = container.streams.video[0]
        pictures = [picture.to_ndarray(format="rgb24") for picture in container.decode(stream)]
    frames = len(loop_frames(beating))
    assert len(pictures) % frames == 0
    assert 4 <= len(pictures) / RATE <= 8
    assert pictures[0].shape == (FILM[1], FILM[0], 3)
    again = pictures[frames].astype(float) - pictures[0]
    assert np.abs(again).mean() < 2
