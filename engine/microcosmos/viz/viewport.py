"""Where things in the periodic box lie in a picture, and fields at the size of the picture."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class View:
    """A picture of one period of the box around a centre; x to the right, y up."""

    centre: np.ndarray
    """The point in the picture's middle, in cells."""

    size: tuple[int, int]
    """Cells along x and y."""

    shape: tuple[int, int]
    """Rows and columns of the picture."""

    @property
    def scale(self) -> np.ndarray:
        """Pixels a cell along x and y."""
        return np.array(self.shape[::-1]) / self.size

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 2) in cells as (column, row); the first pixel's middle is at 0.5."""
        away = (points - self.centre) * [1, -1]
        return (away + np.array(self.size) / 2) * self.scale

    def sampled(self, field: np.ndarray) -> np.ndarray:
        """A periodic field (x, y) at the picture's pixels (row, column).

        Between cells it is Catmull and Rom's cubic spline, which keeps the cells' values.
        """
        (rows, columns), (width, height) = self.shape, self.size
        x = self.centre[0] + ((np.arange(columns) + 0.5) / columns - 0.5) * width
        y = self.centre[1] - ((np.arange(rows) + 0.5) / rows - 0.5) * height
        return _weights(y, height) @ field.astype(np.float32).T @ _weights(x, width).T


def view(size: tuple[int, int], width: int, centre: np.ndarray) -> View:
    """A view of `width` pixels, and as high as the box is; both are even, as films need."""
    if width < 16 or width % 2:
        raise ValueError(f"`width` must be an even number of pixels from 16, got {width}.")
    height = 2 * max(8, round(width * size[1] / size[0] / 2))
    return View(centre, size, (height, width))


def _weights(places: np.ndarray, cells: int) -> np.ndarray:
    """The weight (place, cell) of each cell's value at places along a periodic axis."""
    first = np.floor(places).astype(int)
    t = places - first
    spline = (
        t * (-1 + t * (2 - t)),
        2 + t**2 * (3 * t - 5),
        t * (1 + t * (4 - 3 * t)),
        t**2 * (t - 1),
    )
    weights = np.zeros((len(places), cells), np.float32)
    for offset, weight in enumerate(spline):
        # A box of fewer than four cells meets a cell twice.
        np.add.at(weights, (np.arange(len(places)), (first + offset - 1) % cells), weight / 2)
    return weights
