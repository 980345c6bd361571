"""Pictures and films of a replay: strips, cards for links, GIF and MP4."""

import io
import tempfile
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from platform import machine
from typing import Any

import numpy as np

from ..archive.atomic import write_whole
from ..optional import require
from .raster import frame, theme_of
from .replay_file import Replay, read_replay

GAP = 8
"""Pixels around the panels of a strip."""

LETTERS = 14
"""Height of the captions, in pixels."""


def png(replay: Replay, number: int, **options: Any) -> bytes:
    """Draw one frame as a PNG; `options` are those of `frame`."""
    return encoded(frame(replay, number, **options))


def strip(
    replay: Replay,
    count: int = 6,
    *,
    width: int = 240,
    theme: str = "light",
    note: str = "",
    **options: Any,
) -> bytes:
    """Draw `count` moments from the first frame to the last, each with its step, as a PNG.

    They lie side by side; `width` is one panel's, `note` is written under the last one, and
    `options` are those of `frame`.
    """
    numbers = moments(replay, count)
    panels = [frame(replay, k, width=width, theme=theme, **options) for k in numbers]
    high, wide = panels[0].shape[:2]
    shape = high + 3 * GAP + LETTERS, count * (wide + GAP) + GAP, 3
    sheet = require("PIL.Image").fromarray(np.full(shape, theme_of(theme).halo, np.uint8))
    font = require("PIL.ImageFont").load_default(LETTERS)
    draw, ink = require("PIL.ImageDraw").Draw(sheet), theme_of(theme).ink
    below = GAP + high + GAP // 2
    for place, panel in enumerate(panels):
        left = place * (wide + GAP) + GAP
        sheet.paste(require("PIL.Image").fromarray(panel), (left, GAP))
        caption = f"step {replay.step(numbers[place]):,}"
        draw.text((left, below), caption, fill=ink, font=font, anchor="lt")
    draw.text((count * (wide + GAP), below), note, fill=ink, font=font, anchor="rt")
    return encoded(np.asarray(sheet))


def moments(replay: Replay, count: int) -> list[int]:
    """Return the numbers of `count` frames, evenly from the first to the last."""
    if not 1 <= count <= replay.frames:
        raise ValueError(f"`count` must be from 1 to {replay.frames} frames, got {count}.")
    if count == 1:
        return [replay.frames - 1]
    return [round(k * (replay.frames - 1) / (count - 1)) for k in range(count)]


def encoded(picture: np.ndarray) -> bytes:
    out = io.BytesIO()
    require("PIL.Image").fromarray(picture).save(out, "PNG", optimize=True)
    return out.getvalue()


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
    # Every k-th frame, rounded up: at most `frames` of them, evenly apart.
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
    # No version of FFmpeg in the file: the same replay is the same film
    # (test_an_mp4_is_the_same_every_time).
    kept = {"movflags": "faststart", "fflags": "bitexact"}
    options = QUALITY | (X86 if machine() in ("x86_64", "AMD64") else {})
    with av.open(str(path), "w", options=kept) as film:
        stream = film.add_stream(ENCODER, rate=rate, options=options)
        stream.pix_fmt = "yuv420p"
        stream.thread_count = 1  # With more, the film depends on the machine.
        first = next(pictures)
        stream.height, stream.width = first.shape[:2]
        context = stream.codec_context
        # Players guess the colours of a film that does not state them
        # (test_an_mp4_keeps_the_colours_of_still_water_and_can_be_streamed).
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
    write_whole(path, MAKERS[path.suffix.lower()](read_replay(data), **options))


PICTURE, FILM = (1200, 630), (800, 420)
"""Pixels: most sites cut pictures to the first; a film is smaller."""

MOMENT = 2 / 3
"""Share of the replay by which the wake has formed."""

FEWEST = 20
"""Frames of the shortest loop."""
FILM_FRAMES, RATE = 100, 25
"""Fewest frames of the film, which repeats the loop, and frames a second."""

MARGIN, LONGEST, SCALE_LETTERS = 28, 220, 22
"""Pixels: distance of the scale bar from the edges, its greatest length, height of its text."""
LENGTHS = [step * 10**power for power in range(4) for step in (1, 2, 5)]
"""Lengths of scale bars, in cells."""


def preview(replay: Replay, theme: str = "light") -> bytes:
    """Draw one moment as a PNG."""
    number = round(MOMENT * (replay.frames - 1))
    return encoded(next(cards(replay, [number], PICTURE, theme)))


def loop(replay: Replay, theme: str = "light") -> bytes:
    """Return a film in H.264 of a few seconds, which ends as it begins."""
    numbers = loop_frames(replay)
    pictures = list(cards(replay, numbers, FILM, theme))
    times = -(-FILM_FRAMES // len(pictures))
    return film(iter(pictures * times), RATE)


def loop_frames(replay: Replay) -> range:
    """Return the numbers of the frames between two poses of the same shape, the last included.

    The first is the one in the second half of the replay whose shape is the nearest to that of
    the last frame, at least `FEWEST` frames before it.
    """
    last = replay.frames - 1
    shapes = replay.positions - replay.positions.mean(1, keepdims=True)
    early = range(replay.frames // 2, last - FEWEST + 1)
    if not early:
        return range(replay.frames)
    away = ((shapes[early.start : early.stop] - shapes[last]) ** 2).sum((1, 2))
    return range(early[int(np.argmin(away))] + 1, replay.frames)


def cards(
    replay: Replay, numbers: Sequence[int], size: tuple[int, int], theme: str
) -> Iterator[np.ndarray]:
    """Draw frames of a size in pixels, the creature in the middle, with a scale bar.

    They are cut from the periodic box, or show the whole box if that would cut the creature.
    """
    wide, high = replay.size
    fills = max(size[0], size[1] * wide / high)
    reach = np.ptp(replay.positions[list(numbers)], axis=1).max(0) * fills / wide
    width = fills if (reach < size).all() else min(size[0], size[1] * wide / high)
    # H.264 halves the resolution of colours, so that sides are even.
    even = max(16, 2 * int(np.ceil(width / 2)))
    for number in numbers:
        picture = frame(replay, number, width=even, theme=theme, follow=True)
        yield _with_scale(_cut(picture, size, theme), even / wide, theme)


def _cut(picture: np.ndarray, size: tuple[int, int], theme: str) -> np.ndarray:
    """Return the middle of a picture, with nothing where it is smaller."""
    width, height = size
    sheet = np.full((height, width, 3), theme_of(theme).halo, np.uint8)
    rows, columns = picture.shape[:2]
    high, wide = min(rows, height), min(columns, width)
    top, left = (height - high) // 2, (width - wide) // 2
    above, beside = (rows - high) // 2, (columns - wide) // 2
    cut = picture[above : above + high, beside : beside + wide]
    sheet[top : top + high, left : left + wide] = cut
    return sheet


def _with_scale(picture: np.ndarray, cell: float, theme: str) -> np.ndarray:
    """Draw a bar of a round number of cells, of `cell` pixels each, into a corner."""
    cells = max((one for one in LENGTHS if one * cell <= LONGEST), default=LENGTHS[0])
    sheet = require("PIL.Image").fromarray(picture)
    draw, ink = require("PIL.ImageDraw").Draw(sheet), theme_of(theme).ink
    font = require("PIL.ImageFont").load_default(SCALE_LETTERS)
    left, bottom = MARGIN, len(picture) - MARGIN
    draw.line((left, bottom, left + round(cells * cell), bottom), fill=ink, width=3)
    words = f"{cells} cell{'s' if cells > 1 else ''}"
    draw.text((left, bottom - 8), words, fill=ink, font=font, anchor="lb")
    return np.asarray(sheet)
