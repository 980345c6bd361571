"""Still pictures of a replay as PNG files: single frames, strips, link previews."""

import io
from typing import Any

import numpy as np

from ..optional import require
from .raster import frame, theme_of
from .replay_file import Replay

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
    columns: int | None = None,
    width: int = 240,
    theme: str = "light",
    note: str = "",
    **options: Any,
) -> bytes:
    """Draw `count` moments from the first frame to the last, each with its step, as a PNG.

    They lie side by side, or in rows of `columns`; `width` is one panel's, `note` is written
    under the last one, and `options` are those of `frame`.
    """
    numbers = moments(replay, count)
    columns = count if columns is None else columns
    if not 1 <= columns <= count:
        raise ValueError(f"`columns` must be from 1 to {count}, got {columns}.")
    panels = [frame(replay, k, width=width, theme=theme, **options) for k in numbers]
    high, wide = panels[0].shape[:2]
    tall = high + 2 * GAP + LETTERS
    rows = -(-count // columns)
    shape = rows * tall + GAP, columns * (wide + GAP) + GAP, 3
    sheet = require("PIL.Image").fromarray(np.full(shape, theme_of(theme).halo, np.uint8))
    font = require("PIL.ImageFont").load_default(LETTERS)
    draw, ink = require("PIL.ImageDraw").Draw(sheet), theme_of(theme).ink
    for place, panel in enumerate(panels):
        top = place // columns * tall + GAP
        left = place % columns * (wide + GAP) + GAP
        sheet.paste(require("PIL.Image").fromarray(panel), (left, top))
        corner, caption = (left, top + high + GAP // 2), f"step {replay.step(numbers[place]):,}"
        draw.text(corner, caption, fill=ink, font=font, anchor="lt")
    corner = left + wide, top + high + GAP // 2
    draw.text(corner, note, fill=ink, font=font, anchor="rt")
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
