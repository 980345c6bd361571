"""Films of a replay, GIF and MP4, and the export of any picture by its file's ending."""

import io
import tempfile
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from platform import machine
from typing import Any

import numpy as np

from ..optional import require
from .raster import frame
from .replay_file import Replay, read_replay
from .strip import strip

ENCODER = "libx264"
QUALITY = {"preset": "medium", "crf": "18"}
X86 = {"x264-params": "asm=SSE4"}
"""These settings give the same film on every x86: with AVX-512, x264 differs between runs."""

BT709, LIMITED = 1, 1
"""The colours of films of high definition, in the numbers of H.264 and FFmpeg."""

SAMPLES = 12
"""Frames whose colours the palette of a GIF is chosen for."""


def gif(
    replay: Replay, *, width: int = 320, frames: int = 125, rate: int = 20, **options: Any
) -> bytes:
    """Return a looping film of at most `frames` frames, `rate` a second.

    A GIF counts hundredths of a second; viewers show a frame for at least two. `options` are
    those of `frame`.
    """
    if not 1 <= rate <= 50:
        raise ValueError(f"`rate` must be from 1 to 50 frames a second, got {rate}.")
    if frames < 2:
        raise ValueError(f"`frames` must be at least 2, got {frames}.")
    image = require("PIL.Image")
    numbers = range(0, replay.frames, -(-replay.frames // frames))
    pictures = [frame(replay, k, width=width, **options) for k in numbers]
    # One palette for all pictures, so that still parts do not flicker.
    some = np.concatenate(pictures[:: -(-len(pictures) // SAMPLES)])
    palette = image.fromarray(some).quantize(256, image.Quantize.MEDIANCUT)
    first, *others = (
        image.fromarray(picture).quantize(palette=palette, dither=image.Dither.NONE)
        for picture in pictures
    )
    out, moving = io.BytesIO(), {"save_all": True, "append_images": others, "loop": 0}
    first.save(out, "GIF", **moving, duration=10 * round(100 / rate), disposal=1)
    return out.getvalue()


def mp4(replay: Replay, *, width: int = 480, rate: int = 25, **options: Any) -> bytes:
    """Return a film in H.264 of all frames, `rate` a second, that browsers stream.

    `options` are those of `frame`.
    """
    if not 1 <= rate <= 120:
        raise ValueError(f"`rate` must be from 1 to 120 frames a second, got {rate}.")
    return film((frame(replay, k, width=width, **options) for k in range(replay.frames)), rate)


def film(pictures: Iterator[np.ndarray], rate: int) -> bytes:
    """Return a film in H.264 of RGB pictures of one size, even in both directions."""
    if ENCODER not in require("av").codecs_available:
        raise ValueError(
            f"An MP4 needs PyAV with {ENCODER}, which this one was built without; "
            "make a GIF instead."
        )
    with tempfile.TemporaryDirectory() as folder:  # The index is moved to the front at the end.
        path = Path(folder) / "film.mp4"
        _encode(pictures, path, rate)
        return path.read_bytes()


def _encode(pictures: Iterator[np.ndarray], path: Path, rate: int) -> None:
    av = require("av")
    kept = {"movflags": "faststart", "fflags": "bitexact"}
    options = QUALITY | (X86 if machine() in ("x86_64", "AMD64") else {})
    with av.open(str(path), "w", options=kept) as film:
        stream = film.add_stream(ENCODER, rate=rate, options=options)
        stream.pix_fmt = "yuv420p"
        stream.thread_count = 1  # With more, the film depends on the machine.
        first = next(pictures)
        stream.height, stream.width = first.shape[:2]
        context = stream.codec_context
        context.colorspace = context.color_primaries = context.color_trc = BT709
        context.color_range = LIMITED
        for picture in chain([first], pictures):
            image = av.VideoFrame.from_ndarray(picture, format="rgb24")
            film.mux(stream.encode(image.reformat(format="yuv420p", dst_colorspace=BT709)))
        film.mux(stream.encode())


MAKERS = {".png": strip, ".gif": gif, ".mp4": mp4}


def check(path: Path) -> None:
    """Raise if a file of this kind cannot be written, before anything is computed."""
    kind = path.suffix.lower()
    if kind not in MAKERS:
        raise ValueError(f"`path` must end in {', '.join(MAKERS)}, got {str(path)!r}.")
    require("PIL.Image")
    if kind == ".mp4":
        require("av")


def export(data: bytes, path: str | Path, **options: Any) -> None:
    """Write the bytes of a replay as .png (a strip of moments), .gif or .mp4.

    `options` are those of `strip`, `gif` or `mp4`.
    """
    path = Path(path)
    check(path)
    path.write_bytes(MAKERS[path.suffix.lower()](read_replay(data), **options))
