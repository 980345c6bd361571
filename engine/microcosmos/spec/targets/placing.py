"""Pictures as arrays: packed for a spec, resampled, and placed on the lattice."""

from base64 import b64decode, b64encode

import numpy as np

Ink = np.ndarray
"""(row, column) from the top, 0 is paper and 1 is ink."""

MAX_PIXELS = 256
"""Most pixels of a packed picture's longer side."""

SHARPENING = 2.5
"""Factor on the contrast of an enlarged picture."""


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
    found = _weights(rows, new[0]) @ ink @ _weights(columns, new[1]).T
    if scale > 1:
        found = SHARPENING * (found - 0.5) + 0.5
    return np.clip(found, 0, 1)


def field(ink: Ink, size: tuple[int, int], longest: int) -> np.ndarray:
    """Return a lattice (x, y), y upwards, with the picture in its middle."""
    found = fitted(ink, longest)[::-1].T
    plane = np.zeros(size, np.float32)
    x, y = ((whole - part) // 2 for whole, part in zip(size, found.shape, strict=True))
    plane[x : x + found.shape[0], y : y + found.shape[1]] = found
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
