"""The picture by which other sites announce a creature, in their size and with all of it."""

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from microcosmos.viz.raster import THEMES, frame
from microcosmos.viz.strip import HEIGHT, MOMENT, WIDTH, preview

pytestmark = pytest.mark.fast


def opened(data):
    image = Image.open(io.BytesIO(data))
    assert image.format == "PNG"
    return np.asarray(image.convert("RGB"))


@pytest.mark.parametrize("theme", list(THEMES))
def test_it_is_the_middle_of_a_frame_that_follows_the_creature(swimming, theme):
    picture = opened(preview(swimming, theme))
    assert picture.shape == (HEIGHT, WIDTH, 3)
    number = round(MOMENT * (swimming.frames - 1))
    whole = frame(swimming, number, width=WIDTH, theme=theme, follow=True)
    above = (len(whole) - HEIGHT) // 2
    np.testing.assert_array_equal(picture, whole[above : above + HEIGHT])


def test_a_creature_that_would_be_cut_is_shown_in_all_of_its_box(swimming):
    upright = replace(swimming, positions=swimming.positions[..., ::-1] * [1, 2])
    picture = opened(preview(upright))
    halo = THEMES["light"].halo
    assert picture.shape == (HEIGHT, WIDTH, 3)
    assert (picture[:, 0] == halo).all(), "beside the box there is nothing"
    assert (picture[:, -1] == halo).all()
    wide = HEIGHT * 32 // 24
    whole = frame(upright, 20, width=wide, follow=True)
    left = (WIDTH - wide) // 2
    np.testing.assert_array_equal(picture[:, left : left + wide], whole)
