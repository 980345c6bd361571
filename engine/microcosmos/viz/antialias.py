"""Smooth lines in a periodic picture, as distances in pixels to the nearest line."""

import numpy as np

PIECE = 6.0
"""Longer lines are cut into pieces of at most so many pixels."""

BATCH = 4096
"""Pieces whose surroundings are looked at together."""


def distance(
    starts: np.ndarray, ends: np.ndarray, shape: tuple[int, int], reach: float
) -> np.ndarray:
    """The distance (row, column) from each pixel's middle to the nearest line, at most `reach`.

    Lines are (line, 2) points (column, row) in pixels, the first pixel's middle at 0.5. What
    leaves the picture on one side enters on the other.
    """
    field = np.full(shape[0] * shape[1], reach, np.float32)
    starts, ends = _pieces(starts, ends)
    around = np.arange(
        -int(np.ceil(reach + PIECE / 2)) - 1, int(np.ceil(reach + PIECE / 2)) + 2
    )
    for first in range(0, len(starts), BATCH):
        a, b = (points[first : first + BATCH] for points in (starts, ends))
        pixels = np.floor((a + b) / 2).astype(int)[:, :, None] + around  # (piece, 2, place)
        column = (pixels[:, 0] + 0.5 - a[:, :1]).astype(np.float32)[:, None, :]
        row = (pixels[:, 1] + 0.5 - a[:, 1:]).astype(np.float32)[:, :, None]
        places = (pixels[:, 1] % shape[0] * shape[1])[:, :, None] + (pixels[:, 0] % shape[1])[
            :, None, :
        ]
        np.minimum.at(field, places.ravel(), _to_line(column, row, b - a).ravel())
    return field.reshape(shape)


def coverage(distances: np.ndarray, width: float) -> np.ndarray:
    """The share of each pixel that lines of this width cover, edges smoothed over a pixel.

    A line thinner than a pixel is a pixel wide and fainter.
    """
    thickness = max(width, 1.0)
    return (width / thickness) * np.clip(thickness / 2 + 0.5 - distances, 0, 1)


def _to_line(column: np.ndarray, row: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Distances (piece, row, column) from points to a line from the origin to `along`."""
    x, y = along.astype(np.float32).T[:, :, None, None]
    square = np.maximum(x**2 + y**2, np.float32(1e-12))
    share = np.clip((column * x + row * y) / square, 0, 1)
    return np.hypot(column - share * x, row - share * y)


def _pieces(starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same lines, cut into equal pieces where they are long."""
    length = np.hypot(*(ends - starts).T)
    count = np.maximum(1, np.ceil(length / PIECE)).astype(int)
    line = np.repeat(np.arange(len(starts)), count)
    number = np.arange(len(line)) - np.repeat(np.cumsum(count) - count, count)
    step = ((ends - starts) / count[:, None])[line]
    first = starts[line] + number[:, None] * step
    return first, first + step
