"""Pictures to fold into: digits, packed pixels, files, words and MNIST's own format."""

import gzip
import struct

import numpy as np
import pytest
from PIL import Image

from microcosmos import spec
from microcosmos.spec import targets

pytestmark = pytest.mark.fast


def test_ten_digits_of_ink_from_0_to_1():
    inks = [targets.digit(number) for number in range(10)]
    assert all(ink.shape == (8, 8) and ink.min() == 0 for ink in inks)
    assert all(15 / 16 <= ink.max() <= 1 for ink in inks)
    assert len({ink.tobytes() for ink in inks}) == 10
    zero, one = inks[:2]  # A ring and a stroke.
    assert zero[3:5, 3:5].mean() < 0.2 < 0.5 < zero[3:5, [2, 5]].mean()
    assert one[:, 3:5].mean() > 0.8
    assert one[:, [0, 7]].mean() == 0


def test_packed_pixels_come_back():
    ink = np.arange(12).reshape(3, 4) / 255
    assert np.array_equal(targets.decoded(targets.encoded(ink), 4, 3), ink)
    with pytest.raises(ValueError, match="4 × 4 bytes, got 12"):
        targets.decoded(targets.encoded(ink), 4, 4)


@pytest.mark.parametrize("longest", [5, 8, 13, 40])
def test_fitting_keeps_what_is_even_and_where_the_middle_is(longest):
    assert targets.fitted(np.ones((8, 4)), longest).shape == (longest, round(longest / 2))
    np.testing.assert_allclose(targets.fitted(np.ones((8, 8)), longest), 1, atol=1e-12)
    half = np.tile([1.0, 1, 1, 1, 0, 0, 0, 0], (8, 1))
    found = targets.fitted(half, longest)
    assert abs(found.mean() - 0.5) < 0.02
    np.testing.assert_allclose(found + found[:, ::-1], 1, atol=1e-12)


def test_the_first_row_lies_at_the_top_of_the_lattice():
    ink = np.zeros((8, 8))
    ink[0, 0] = 1.0
    plane = targets.field(ink, (20, 16), 8)
    assert plane.dtype == np.float32
    assert np.argwhere(plane > 0.5).tolist() == [[6, 11]]


def test_dark_on_light_and_opaque_on_clear_are_ink(tmp_path):
    drawn = np.full((4, 6), 255, np.uint8)
    drawn[1, 2] = 0
    Image.fromarray(drawn).save(tmp_path / "dark.png")
    clear = np.zeros((4, 6, 4), np.uint8)
    clear[1, 2, 3] = 255
    Image.fromarray(clear).save(tmp_path / "clear.png")
    for name in ("dark.png", "clear.png"):
        assert np.argwhere(targets.png(tmp_path / name)).tolist() == [[1, 2]]


def test_a_file_that_shows_nothing_is_refused(tmp_path):
    (tmp_path / "text.png").write_bytes(b"no picture")
    Image.fromarray(np.full((3, 3), 255, np.uint8)).save(tmp_path / "white.png")
    with pytest.raises(ValueError, match="must be a picture"):
        targets.png(tmp_path / "text.png")
    with pytest.raises(ValueError, match="must show something"):
        targets.png(tmp_path / "white.png")


def test_words_fill_their_picture():
    ink = targets.text("fold")
    assert ink.shape[1] > ink.shape[0]
    assert all(edge.max() > 0 for edge in (ink[0], ink[-1], ink[:, 0], ink[:, -1]))
    with pytest.raises(ValueError, match="show something"):
        targets.text(" ")
    with pytest.raises(ValueError, match="font file"):
        targets.text("a", "no-such-font.ttf")


def idx(images):
    return struct.pack(">IIII", 2051, *images.shape) + images.astype(np.uint8).tobytes()


@pytest.mark.parametrize("packed", [False, True])
def test_mnist_files_are_read_packed_or_not(tmp_path, packed):
    images = np.random.default_rng(1).integers(0, 256, (3, 5, 4))
    path = tmp_path / "images"
    path.write_bytes(gzip.compress(idx(images)) if packed else idx(images))
    assert np.array_equal(targets.mnist(path, 2), images[2] / 255)


def test_broken_mnist_files_are_refused(tmp_path):
    path, whole = tmp_path / "images", idx(np.ones((3, 5, 4)))
    for data, number, needed in (
        (b"\x00\x00\x08\x01" + whole[4:], 0, "IDX file of images"),
        (whole[:-1], 0, "3 pictures of 5 × 4 bytes, got 59"),
        (whole, 3, "from 0 to 2, got 3"),
    ):
        path.write_bytes(data)
        with pytest.raises(ValueError, match=needed):
            targets.mnist(path, number)


def test_a_picture_stands_in_a_spec_and_survives_json():
    ink = np.round(255 * targets.text("a")) / 255
    target = spec.picture("a", ink)
    again = spec.Picture.model_validate_json(target.model_dump_json())
    np.testing.assert_array_equal(again.ink, ink)
