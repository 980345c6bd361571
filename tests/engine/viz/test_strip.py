"""Still pictures are PNG files that show the frames they say."""

import io
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from microcosmos.optional import require
from microcosmos.viz.raster import THEMES, frame
from microcosmos.viz.strip import GAP, LETTERS, moments, png, strip

pytestmark = pytest.mark.fast


def opened(data):
    image = Image.open(io.BytesIO(data))
    assert image.format == "PNG"
    return np.asarray(image.convert("RGB"))


def test_a_png_is_the_frame_itself(swimming):
    picture = opened(png(swimming, 7, width=100, theme="dark"))
    np.testing.assert_array_equal(picture, frame(swimming, 7, width=100, theme="dark"))


@pytest.mark.parametrize(("count", "columns"), [(1, None), (4, None), (5, 2), (6, 3)])
def test_a_strip_has_the_moments_side_by_side(swimming, count, columns):
    sheet = opened(strip(swimming, count, columns=columns, width=64))
    across = columns or count
    tall = 48 + 2 * GAP + LETTERS
    assert sheet.shape[:2] == (-(-count // across) * tall + GAP, across * (64 + GAP) + GAP)
    for place, number in enumerate(moments(swimming, count)):
        top, left = place // across * tall + GAP, place % across * (64 + GAP) + GAP
        panel = sheet[top : top + 48, left : left + 64]
        np.testing.assert_array_equal(panel, frame(swimming, number, width=64))


def test_moments_go_evenly_from_the_first_frame_to_the_last(swimming):
    assert moments(swimming, 4) == [0, 10, 20, 30]
    assert moments(swimming, 1) == [30]
    assert moments(swimming, 31) == list(range(31))


def test_each_moment_has_its_step_written_below_it(swimming):
    slower = replace(swimming, header=swimming.header | {"every": 50})
    assert [replay.step(15) for replay in (swimming, slower)] == [75, 750]
    sheet, other = (opened(strip(replay, 3, width=64)) for replay in (swimming, slower))
    changed = (sheet != other).any(-1)
    assert not changed[: GAP + 48].any()
    first, second, third = (changed[:, k * (64 + GAP) : (k + 1) * (64 + GAP)] for k in range(3))
    assert not first.any()  # Step 0 in both.
    assert second.any()
    assert third.any()
    written = (np.abs(sheet[GAP + 48 :].astype(int) - THEMES["light"].ink).max(-1) < 60).any(0)
    assert all(written[k * (64 + GAP) :][: 64 + GAP].any() for k in range(3))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"count": 0}, "`count` must be from 1 to 31 frames, got 0"),
        ({"count": 32}, "`count` must be from 1 to 31 frames, got 32"),
        ({"count": 3, "columns": 4}, "`columns` must be from 1 to 3, got 4"),
        ({"count": 3, "columns": 0}, "`columns` must be from 1 to 3, got 0"),
    ],
)
def test_a_strip_that_cannot_be_is_refused(swimming, options, message):
    with pytest.raises(ValueError, match=message):
        strip(swimming, **options)


def test_a_library_that_is_missing_is_named_with_what_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    command = r'PIL is needed: pip install "microcosmos\[figures\]"'
    with pytest.raises(ImportError, match=command):
        require("PIL")
