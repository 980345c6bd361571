"""One frame of a replay as a picture: vorticity, obstacles, the path so far, the body.

The picture shows the periodic box once, x to the right and y up. The colours are the page's.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .replay_file import Replay


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
        """Pixels per cell along x and y."""
        return np.array(self.shape[::-1]) / self.size

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Map points (..., 2) in cells to (column, row); the first pixel's middle is at 0.5."""
        away = (points - self.centre) * [1, -1]
        return (away + np.array(self.size) / 2) * self.scale

    def sampled(self, field: np.ndarray) -> np.ndarray:
        """Sample a periodic field (x, y) at the picture's pixels (row, column).

        Between cells it is Catmull and Rom's cubic spline, which keeps the cells' values.
        """
        (rows, columns), (width, height) = self.shape, self.size
        x = self.centre[0] + ((np.arange(columns) + 0.5) / columns - 0.5) * width
        y = self.centre[1] - ((np.arange(rows) + 0.5) / rows - 0.5) * height
        return _weights(y, height) @ field.astype(np.float32).T @ _weights(x, width).T

    def nearest(self, field: np.ndarray) -> np.ndarray:
        """Return the values (row, column) of a periodic field's cells (x, y) at pixels."""
        (rows, columns), (width, height) = self.shape, self.size
        x = self.centre[0] + ((np.arange(columns) + 0.5) / columns - 0.5) * width
        y = self.centre[1] - ((np.arange(rows) + 0.5) / rows - 0.5) * height
        x, y = np.rint(x).astype(int) % width, np.rint(y).astype(int) % height
        return field[x[None, :], y[:, None]]


def view(size: tuple[int, int], width: int, centre: np.ndarray) -> View:
    """Return a view of `width` pixels, and as high as the box; both are even, as films need."""
    if width < 16 or width % 2:
        raise ValueError(f"`width` must be an even number of pixels from 16, got {width}.")
    height = 2 * max(8, round(width * size[1] / size[0] / 2))
    return View(centre, size, (height, width))


def _weights(places: np.ndarray, cells: int) -> np.ndarray:
    """Return the weight (place, cell) of each cell's value at places along a periodic axis."""
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


GRID = 8
"""Cells between the dots that mark the fluid's rest frame."""

CURVE = 4
"""Straight lines of a drawn edge."""

Colour = tuple[int, int, int]


@dataclass(frozen=True)
class Theme:
    """Colours (red, green, blue)."""

    vorticity: tuple[Colour, ...]
    """Colours from the most negative vorticity to the most positive; zero is the background."""

    ink: Colour
    halo: Colour
    """Colour between the body and the flow."""
    solid: Colour
    """Colour of obstacles."""


THEMES = {
    "light": Theme(
        ((20, 66, 138), (92, 152, 206), (246, 248, 249), (228, 126, 98), (146, 24, 34)),
        ink=(18, 34, 44),
        halo=(255, 255, 255),
        solid=(128, 140, 148),
    ),
    "dark": Theme(
        ((148, 206, 255), (44, 110, 178), (11, 20, 26), (178, 72, 48), (255, 190, 148)),
        ink=(253, 248, 236),
        halo=(4, 10, 14),
        solid=(92, 104, 112),
    ),
}


def frame(
    replay: Replay,
    number: int,
    *,
    width: int = 480,
    theme: str = "light",
    follow: bool = False,
    way: bool = True,
) -> np.ndarray:
    """Draw frame `number` (from the end if negative) as pixels (row, column, 3) of uint8.

    The camera rests in the middle of the box, or follows the mean position of the nodes.
    `way` draws the path of each creature's mean position, with a ring at its start.
    """
    number, colours = frame_number(replay, number), theme_of(theme)
    middle = replay.positions[number].mean(0, dtype=float)
    seen = view(replay.size, width, middle if follow else np.array(replay.size) / 2)
    # The strongest vorticity has the first or last colour.
    share = seen.sampled(replay.levels[number]) * np.float32(replay.quantum / replay.strongest)
    picture = _table(theme)[np.rint(255 * np.clip(share, -1, 1)).astype(np.int16) + 255]
    _blend(picture, colours.solid, seen.nearest(replay.solid).astype(np.float32))
    dots = seen.pixels(_grid(seen))
    _blend(picture, colours.ink, 0.22 * coverage(distance(dots, dots, seen.shape, 2), 2))
    if way:
        path = seen.pixels(replay.centres[: number + 1])
        starts, ends = path[:-1].reshape(-1, 2), path[1:].reshape(-1, 2)
        line = coverage(distance(starts, ends, seen.shape, 2), 1.25)
        ring = coverage(np.abs(distance(path[0], path[0], seen.shape, 5) - 3), 1.25)
        _blend(picture, colours.ink, 0.55 * np.maximum(line, ring))
    thick = max(3.0, 0.8 * seen.scale.mean())
    starts, ends = seen.pixels(_curves(replay, number))
    near = distance(starts, ends, seen.shape, thick / 2 + 3)
    # The halo first: the body then stands out from vorticity of any colour.
    _blend(picture, colours.halo, 0.8 * coverage(near, thick + 3))
    _blend(picture, colours.ink, coverage(near, thick))
    return np.rint(picture).astype(np.uint8)


def frame_number(replay: Replay, number: int) -> int:
    """Return the number of a frame, counted from the start."""
    if not -replay.frames <= number < replay.frames:
        raise ValueError(f"`number` must be within {replay.frames} frames, got {number}.")
    return number % replay.frames


def theme_of(name: str) -> Theme:
    if name not in THEMES:
        raise ValueError(f"`theme` must be one of {', '.join(THEMES)}, got {name!r}.")
    return THEMES[name]


@lru_cache
def _table(theme: str) -> np.ndarray:
    anchors = np.array(THEMES[theme].vorticity).T
    places = np.linspace(-1, 1, anchors.shape[1])
    table = [np.interp(np.linspace(-1, 1, 511), places, channel) for channel in anchors]
    return np.stack(table, 1).astype(np.float32)


def _grid(seen: View) -> np.ndarray:
    """Return the dots (dot, 2) in view, in cells."""
    first = seen.centre - np.array(seen.size) / 2
    x, y = (
        np.arange(np.ceil(low / GRID) * GRID, low + side, GRID)
        for low, side in zip(first, seen.size, strict=True)
    )
    return np.stack(np.meshgrid(x, y), -1).reshape(-1, 2)


def _curves(replay: Replay, number: int) -> np.ndarray:
    """Return short lines (2, line, 2), from and to, along the splines through the nodes.

    Catmull and Rom's spline runs through a node that joins two edges; it ends at others.
    """
    nodes, (a, b) = replay.positions[number].astype(float), replay.edges.T
    ends = np.concatenate([a, b])
    joined = np.bincount(ends, minlength=len(nodes)) == 2
    sums = np.bincount(ends, np.concatenate([b, a]), len(nodes)).astype(int)
    before = nodes[np.where(joined[a], sums[a] - b, a)]
    after = nodes[np.where(joined[b], sums[b] - a, b)]
    a, b = nodes[a], nodes[b]
    t = np.linspace(0, 1, CURVE + 1)[:, None, None]
    points = (
        2 * a
        + t * (b - before)
        + t**2 * (2 * before - 5 * a + 4 * b - after)
        + t**3 * (3 * a - before - 3 * b + after)
    ) / 2
    return np.stack([points[:-1].reshape(-1, 2), points[1:].reshape(-1, 2)])


def _blend(picture: np.ndarray, colour: Colour, opacity: np.ndarray) -> None:
    # Lines cover few pixels of a picture.
    painted = np.flatnonzero(opacity)
    pixels = picture.reshape(-1, 3)
    share = opacity.ravel()[painted][:, None].astype(np.float32)
    pixels[painted] += share * (np.array(colour, np.float32) - pixels[painted])


PIECE = 6.0
"""Longest piece of a line, in pixels."""

BATCH = 4096
"""Pieces in one batch."""


def distance(
    starts: np.ndarray, ends: np.ndarray, shape: tuple[int, int], reach: float
) -> np.ndarray:
    """Return distances (row, column) of pixels' middles to the nearest line, up to `reach`.

    Lines are (line, 2) points (column, row) in pixels, the first pixel's middle at 0.5. The
    picture is periodic.
    """
    field = np.full(shape[0] * shape[1], reach, np.float32)
    starts, ends = _pieces(starts, ends)
    side = int(np.ceil(reach + PIECE / 2)) + 1
    around = np.arange(-side, side + 1)
    # In batches, since arrays of pixels grow with the number of pieces.
    for first in range(0, len(starts), BATCH):
        a, b = (points[first : first + BATCH] for points in (starts, ends))
        pixels = np.floor((a + b) / 2).astype(int)[:, :, None] + around  # (piece, 2, place)
        column = (pixels[:, 0] + 0.5 - a[:, :1]).astype(np.float32)[:, None, :]
        row = (pixels[:, 1] + 0.5 - a[:, 1:]).astype(np.float32)[:, :, None]
        rows, columns = pixels[:, 1] % shape[0], pixels[:, 0] % shape[1]
        places = (rows * shape[1])[:, :, None] + columns[:, None, :]
        # Pieces share pixels: an assignment would keep the last distance, not the least.
        np.minimum.at(field, places.ravel(), _to_line(column, row, b - a).ravel())
    return field.reshape(shape)


def coverage(distances: np.ndarray, width: float) -> np.ndarray:
    """Return the share of each pixel that lines of this width cover, smoothed over a pixel.

    A line thinner than a pixel is drawn a pixel wide and fainter.
    """
    thickness = max(width, 1.0)
    return (width / thickness) * np.clip(thickness / 2 + 0.5 - distances, 0, 1)


def _to_line(column: np.ndarray, row: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Return distances (piece, row, column) from points to the line from 0 to `along`."""
    x, y = along.astype(np.float32).T[:, :, None, None]
    square = np.maximum(x**2 + y**2, np.float32(1e-12))
    share = np.clip((column * x + row * y) / square, 0, 1)
    return np.hypot(column - share * x, row - share * y)


def _pieces(starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    length = np.hypot(*(ends - starts).T)
    count = np.maximum(1, np.ceil(length / PIECE)).astype(int)
    line = np.repeat(np.arange(len(starts)), count)
    number = np.arange(len(line)) - np.repeat(np.cumsum(count) - count, count)
    step = ((ends - starts) / count[:, None])[line]
    first = starts[line] + number[:, None] * step
    return first, first + step
