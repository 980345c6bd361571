"""Pictures from image files, text and MNIST files."""

import gzip
import struct
from pathlib import Path

import numpy as np

from ...optional import require
from .pictures import MAX_PIXELS, Ink, fitted

IMAGES = 2051
"""First word of an IDX file of images (LeCun, Cortes and Burges, The MNIST database)."""

LARGEST = 4096
"""Most pixels along a side; larger picture files are reduced on reading."""


def png(path: str | Path) -> Ink:
    """Return the ink of a picture file: dark pixels, or opaque ones if some are transparent.

    Large pictures are reduced. Raises `ValueError` where the file is no picture or blank.
    """
    images = require("PIL.Image")
    try:
        with images.open(path) as image:
            image.thumbnail((LARGEST, LARGEST))
            grey = np.asarray(image.convert("LA"), float) / 255
    except (OSError, SyntaxError, images.DecompressionBombError) as error:
        raise ValueError(f"`path` must be a picture, got {str(path)!r}: {error}") from error
    light, opaque = grey[..., 0], grey[..., 1]
    return _small(opaque if opaque.min() < 1 else 1 - light, str(path))


def text(words: str, font: str | Path | None = None, size: int = 128) -> Ink:
    """Return the ink of words in a font file or Pillow's font, `size` pixels high."""
    images, draw, fonts = (
        require(f"PIL.{part}") for part in ("Image", "ImageDraw", "ImageFont")
    )
    try:
        face = fonts.truetype(str(font), size) if font else fonts.load_default(size)
    except OSError as error:
        raise ValueError(f"`font` must be a font file, got {str(font)!r}: {error}") from error
    left, top, right, bottom = face.getbbox(words)
    if right <= left or bottom <= top or not words.strip():
        raise ValueError(f"`words` must show something, got {words!r}.")
    image = images.new("L", (int(right - left), int(bottom - top)))
    draw.Draw(image).text((-left, -top), words, fill=255, font=face)
    ink = np.asarray(image, float) / 255
    rows, columns = (np.flatnonzero(ink.any(axis)) for axis in (1, 0))
    return _small(ink[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1], repr(words))


def mnist(path: str | Path, number: int) -> Ink:
    """Return picture `number` of an MNIST (IDX) file, with or without gzip."""
    data = Path(path).read_bytes()
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    if len(data) < 16 or struct.unpack(">I", data[:4])[0] != IMAGES:
        raise ValueError(f"`path` must be an IDX file of images, got {str(path)!r}.")
    count, rows, columns = struct.unpack(">III", data[4:16])
    if len(data) != 16 + count * rows * columns:
        raise ValueError(
            f"`path` must hold {count} pictures of {rows} × {columns} bytes, got "
            f"{len(data) - 16} bytes."
        )
    if not 0 <= number < count:
        raise ValueError(f"`number` must be from 0 to {count - 1}, got {number}.")
    pixels = np.frombuffer(data, np.uint8, rows * columns, 16 + number * rows * columns)
    return pixels.reshape(rows, columns) / 255


def _small(ink: Ink, what: str) -> Ink:
    if ink.max() == 0:
        raise ValueError(f"a picture must show something dark, got a blank one in {what}.")
    return fitted(ink, MAX_PIXELS) if max(ink.shape) > MAX_PIXELS else ink
