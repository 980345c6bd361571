"""Pictures that filaments fold into: digits, image files, text and MNIST files."""

import gzip
import struct
import zlib
from base64 import b64decode, b64encode
from pathlib import Path

import numpy as np

from ..invalid import InvalidField
from ..optional import require

Ink = np.ndarray
"""(row, column) from the top, 0 is paper and 1 is ink."""

MAX_PIXELS = 256
"""Most pixels of a packed picture's longer side."""

SHARPENING = 2.5
"""Factor on the contrast of an enlarged picture."""

GREYS = "0123456789abcdefg"

DIGITS = (
    "005d9100 00dfaf50 03f20b80 04c00880 05800980 04b01c70 02e5ac00 006da000",
    "000cd500 000bg900 003fg600 07fgg200 001gg300 001gg600 001gg600 000bga00",
    "0004fc00 003gfe00 008d8g00 0016fb00 018df100 09gg5000 03dggb50 0003bg90",
    "007fd100 08d6f400 021dd000 002fb100 0001cc10 00001a80 00845e90 007dd900",
    "0001b000 00078000 001d6220 007f0980 05ga0g60 04fgdg10 0003fa00 0002g400",
    "00ca0000 00egge00 00dgfa10 00bgg700 00047g70 00004g90 0054cg40 009gga00",
    "000cd000 005g8000 00dg3000 00ed0000 00fc7200 00dgdg30 007gbf80 0019fb30",
    "0078dgf1 00774bc0 00008d10 0488ff60 02bff400 000g5000 009f1000 00d50000",
    "009e8100 00ceec00 009a0f40 003gce20 004gg200 03g8ad20 01f13g80 00bgfb10",
    "00bc0000 02gggd00 03gcae00 01g1cf00 00dg9f20 000309b0 00009f40 009cd300",
)
"""Handwritten digits: rows from the top, one character per pixel.

The first of each class in "Optical Recognition of Handwritten Digits", E. Alpaydin and
C. Kaynak (1998), UCI Machine Learning Repository, doi:10.24432/C50P49, CC BY 4.0; the same ten
that scikit-learn's `load_digits` begins with.
"""


def digit(number: int) -> Ink:
    """Return the ink (row, column) of a digit, from 0 to 1."""
    rows = DIGITS[number].split()
    return np.array([[GREYS.index(pixel) for pixel in row] for row in rows]) / 16


def encoded(ink: Ink) -> str:
    """Return base64 of one byte per pixel, row by row."""
    return b64encode(np.round(255 * np.clip(ink, 0, 1)).astype(np.uint8).tobytes()).decode()


def decoded(pixels: str, width: int, height: int) -> Ink:
    """Return the picture; raise `ValueError` for another number of bytes."""
    data = b64decode(pixels, validate=True)
    if len(data) != width * height:
        raise ValueError(f"needs {width} × {height} bytes, got {len(data)}")
    return np.frombuffer(data, np.uint8).reshape(height, width) / 255


def fitted(ink: Ink, longest: int) -> Ink:
    """Resample a picture to a longer side of `longest` pixels.

    An enlarged picture is sharpened: a filament cannot reproduce grey edges.
    """
    rows, columns = ink.shape
    scale = longest / max(rows, columns)
    new = [max(1, round(scale * rows)), max(1, round(scale * columns))]
    resampled = _weights(rows, new[0]) @ ink @ _weights(columns, new[1]).T
    if scale > 1:
        resampled = SHARPENING * (resampled - 0.5) + 0.5
    return np.clip(resampled, 0, 1)


def field(ink: Ink, size: tuple[int, int], longest: int) -> np.ndarray:
    """Return a lattice (x, y), y upwards, with the picture in its middle."""
    picture = fitted(ink, longest)[::-1].T
    plane = np.zeros(size, np.float32)
    x, y = ((whole - part) // 2 for whole, part in zip(size, picture.shape, strict=True))
    plane[x : x + picture.shape[0], y : y + picture.shape[1]] = picture
    return plane


def _weights(old: int, new: int) -> np.ndarray:
    """(new, old) weights of Keys's cubic kernel (IEEE Trans. ASSP 29, 1153, 1981; a = −1/2),
    widened where a picture shrinks; each row sums to 1."""
    scale = old / new
    width = max(1.0, scale)
    middle = (np.arange(new) + 0.5) * scale - 0.5
    t = np.abs(np.arange(old)[None] - middle[:, None]) / width
    near = (1.5 * t - 2.5) * t * t + 1
    far = ((-0.5 * t + 2.5) * t - 4) * t + 2
    weights = np.where(t < 1, near, np.where(t < 2, far, 0.0))
    return weights / weights.sum(1, keepdims=True)


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
        raise InvalidField("path", f"must be a picture, got {str(path)!r}: {error}") from error
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
        raise InvalidField(
            "font", f"must be a font file, got {str(font)!r}: {error}"
        ) from error
    left, top, right, bottom = face.getbbox(words)
    if right <= left or bottom <= top or not words.strip():
        raise InvalidField("words", f"must show something, got {words!r}.")
    image = images.new("L", (int(right - left), int(bottom - top)))
    draw.Draw(image).text((-left, -top), words, fill=255, font=face)
    ink = np.asarray(image, float) / 255
    rows, columns = (np.flatnonzero(ink.any(axis)) for axis in (1, 0))
    return _small(ink[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1], repr(words))


def mnist(path: str | Path, number: int) -> Ink:
    """Return picture `number` of an MNIST (IDX) file, with or without gzip."""
    data = Path(path).read_bytes()
    if data[:2] == b"\x1f\x8b":
        try:
            data = gzip.decompress(data)
        except (OSError, EOFError, zlib.error) as error:
            raise InvalidField(
                "path", f"must be a whole gzip file, got {str(path)!r}: {error}"
            ) from error
    if len(data) < 16 or struct.unpack(">I", data[:4])[0] != IMAGES:
        raise InvalidField("path", f"must be an IDX file of images, got {str(path)!r}.")
    count, rows, columns = struct.unpack(">III", data[4:16])
    if len(data) != 16 + count * rows * columns:
        raise InvalidField(
            "path",
            f"must hold {count} pictures of {rows} × {columns} bytes, got "
            f"{len(data) - 16} bytes.",
        )
    if not 0 <= number < count:
        raise InvalidField("number", f"must be from 0 to {count - 1}, got {number}.")
    pixels = np.frombuffer(data, np.uint8, rows * columns, 16 + number * rows * columns)
    return pixels.reshape(rows, columns) / 255


def _small(ink: Ink, what: str) -> Ink:
    if ink.max() == 0:
        raise ValueError(f"a picture must show something dark, got a blank one in {what}.")
    return fitted(ink, MAX_PIXELS) if max(ink.shape) > MAX_PIXELS else ink
