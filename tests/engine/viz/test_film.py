"""Films have the requested frames, size and pace; notebooks play them."""

import io
import os
from platform import machine

import av
import numpy as np
import pytest
from PIL import Image

from microcosmos.viz import film as module
from microcosmos.viz.film import export, gif, mp4
from microcosmos.viz.notebook import filmed
from microcosmos.viz.raster import frame

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def film(swimming):
    return mp4(swimming, width=160, rate=20)


def shown(image):
    return np.asarray(image.convert("RGB"), float)


@pytest.mark.parametrize(("most", "every", "count"), [(125, 1, 31), (31, 1, 31), (10, 4, 8)])
def test_a_gif_has_every_so_many_frames(swimming, most, every, count):
    image = Image.open(io.BytesIO(gif(swimming, width=160, frames=most, rate=20)))
    assert image.format == "GIF"
    assert image.n_frames == count
    assert image.size == (160, 120)
    for number in range(count):
        image.seek(number)
        assert image.info["duration"] == 50
        source = frame(swimming, every * number, width=160)
        # All frames share 256 colours.
        away = np.abs(shown(image) - source)
        assert away.mean() < 2
        assert np.quantile(away, 0.999) < 32


def test_a_gif_starts_again_at_its_end_and_is_the_same_every_time(swimming):
    data = gif(swimming, width=64)
    assert Image.open(io.BytesIO(data)).info["loop"] == 0
    assert gif(swimming, width=64) == data


def test_an_mp4_has_every_frame_at_its_size_and_pace(film, swimming):
    with av.open(io.BytesIO(film)) as container:
        stream = container.streams.video[0]
        assert (stream.codec.name, stream.pix_fmt) == ("h264", "yuv420p")
        assert stream.average_rate == 20
        assert container.duration == pytest.approx(31 / 20 * av.time_base, rel=1e-3)
        pictures = list(container.decode(stream))
    assert len(pictures) == 31
    for number, picture in enumerate(pictures):
        source = frame(swimming, number, width=160).astype(float)
        got = picture.to_ndarray(format="rgb24")
        assert got.shape == source.shape
        assert picture.pts * picture.time_base == pytest.approx(number / 20)
        assert np.abs(got - source).mean() < 4


@pytest.mark.skipif(machine() not in ("x86_64", "AMD64"), reason="other machines untried")
def test_an_mp4_is_the_same_every_time(film, swimming):
    assert mp4(swimming, width=160, rate=20) == film


def test_an_mp4_without_an_encoder_is_refused(swimming, monkeypatch):
    monkeypatch.setattr(module, "ENCODER", "libabsent")
    with pytest.raises(ValueError, match=r"PyAV with libabsent.*make a GIF instead"):
        mp4(swimming)


@pytest.mark.parametrize(
    ("maker", "options", "message"),
    [
        (gif, {"rate": 51}, "`rate` must be from 1 to 50 frames a second, got 51"),
        (gif, {"frames": 1}, "`frames` must be at least 2, got 1"),
        (mp4, {"rate": 0}, "`rate` must be from 1 to 120 frames a second, got 0"),
        (mp4, {"width": 161}, "`width` must be an even number"),
    ],
)
def test_a_film_that_cannot_be_is_refused(swimming, maker, options, message):
    with pytest.raises(ValueError, match=message):
        maker(swimming, **options)


@pytest.mark.parametrize(
    ("name", "begins"),
    [("a.png", b"\x89PNG"), ("b.GIF", b"GIF89a"), ("c.mp4", b"\0\0\0\x20ftyp")],
)
def test_an_export_is_what_its_name_says(eel, tmp_path, name, begins):
    export(eel, tmp_path / name, width=64)
    assert (tmp_path / name).read_bytes().startswith(begins)


def test_an_export_that_fails_leaves_the_earlier_file(eel, tmp_path, monkeypatch):
    def full(_):
        raise OSError("the disk is full")

    path = tmp_path / "a.png"
    path.write_bytes(b"earlier")
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="the disk is full"):
        export(eel, path, width=64)
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]


def test_own_frames_become_a_replay_of_the_same_motion(swimming):
    made = filmed(swimming.positions, swimming.edges, swimming.vorticity, every=5)
    np.testing.assert_array_equal(made.positions, swimming.positions)
    np.testing.assert_array_equal(made.edges, swimming.edges)
    np.testing.assert_allclose(made.vorticity, swimming.vorticity, atol=made.quantum)
    assert (made.size, made.step(2)) == (swimming.size, 10)
