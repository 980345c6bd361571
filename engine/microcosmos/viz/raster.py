"""One moment of a replay as a picture: the flow's vorticity, the way gone, the body.

The picture shows the periodic box once, x to the right and y up: what leaves it on one side
enters on the other. The colours are those of the page.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .antialias import coverage, distance
from .replay_file import Replay
from .viewport import View, view

GRID = 8
"""Cells between the dots that stand still in the fluid."""

CURVE = 4
"""Straight lines that an edge is drawn with."""

Colour = tuple[int, int, int]


@dataclass(frozen=True)
class Theme:
    """Colours (red, green, blue)."""

    vorticity: tuple[Colour, ...]
    """From the most negative to the most positive, evenly spaced; zero is the background."""

    ink: Colour
    halo: Colour
    """What is between the body and the flow around it."""


THEMES = {
    "light": Theme(
        ((20, 66, 138), (92, 152, 206), (246, 248, 249), (228, 126, 98), (146, 24, 34)),
        ink=(18, 34, 44),
        halo=(255, 255, 255),
    ),
    "dark": Theme(
        ((148, 206, 255), (44, 110, 178), (11, 20, 26), (178, 72, 48), (255, 190, 148)),
        ink=(253, 248, 236),
        halo=(4, 10, 14),
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
    """Frame `number` (from the end where negative) as pixels (row, column, 3) of uint8.

    The camera rests in the middle of the box, or follows the mean position of the nodes;
    `way` draws where each creature's mean position has been, with a ring where it began.
    """
    number, colours = frame_number(replay, number), theme_of(theme)
    middle = replay.positions[number].mean(0, dtype=float)
    seen = view(replay.size, width, middle if follow else np.array(replay.size) / 2)
    picture = _water(replay, number, seen, theme)
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
    _blend(picture, colours.halo, 0.8 * coverage(near, thick + 3))
    _blend(picture, colours.ink, coverage(near, thick))
    return np.rint(picture).astype(np.uint8)


def frame_number(replay: Replay, number: int) -> int:
    """The number of a frame, counted from the start."""
    if not -replay.frames <= number < replay.frames:
        raise ValueError(f"`number` must be within {replay.frames} frames, got {number}.")
    return number % replay.frames


def theme_of(name: str) -> Theme:
    if name not in THEMES:
        raise ValueError(f"`theme` must be one of {', '.join(THEMES)}, got {name!r}.")
    return THEMES[name]


def _water(replay: Replay, number: int, seen: View, theme: str) -> np.ndarray:
    """The colours (row, column, 3) of the vorticity; the strongest has those at the ends."""
    share = seen.sampled(replay.levels[number]) * np.float32(replay.quantum / replay.strongest)
    return _table(theme)[np.rint(255 * np.clip(share, -1, 1)).astype(np.int16) + 255]


@lru_cache
def _table(theme: str) -> np.ndarray:
    """Colours (511, 3) from -1 to 1."""
    anchors = np.array(THEMES[theme].vorticity).T
    places = np.linspace(-1, 1, anchors.shape[1])
    table = [np.interp(np.linspace(-1, 1, 511), places, channel) for channel in anchors]
    return np.stack(table, 1).astype(np.float32)


def _grid(seen: View) -> np.ndarray:
    """The dots (dot, 2) in view, in cells."""
    first = seen.centre - np.array(seen.size) / 2
    x, y = (
        np.arange(np.ceil(low / GRID) * GRID, low + side, GRID)
        for low, side in zip(first, seen.size, strict=True)
    )
    return np.stack(np.meshgrid(x, y), -1).reshape(-1, 2)


def _curves(replay: Replay, number: int) -> np.ndarray:
    """Short lines (2, line, 2), from and to, along the splines through the nodes.

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
    """Paints over a picture where the opacity (row, column) is above zero."""
    painted = np.flatnonzero(opacity)
    pixels = picture.reshape(-1, 3)
    share = opacity.ravel()[painted][:, None].astype(np.float32)
    pixels[painted] += share * (np.array(colour, np.float32) - pixels[painted])
