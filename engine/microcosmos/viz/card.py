"""Cards of a replay, which other sites show beside a link: a picture and a looping film."""

from collections.abc import Iterator, Sequence

import numpy as np

from ..optional import require
from .film import film
from .raster import frame, theme_of
from .replay_file import Replay
from .strip import encoded

PICTURE, FILM = (1200, 630), (800, 420)
"""Pixels: most sites cut pictures to the first; a film is smaller."""

MOMENT = 2 / 3
"""Share of the replay by which the wake has formed."""

FEWEST = 20
"""Frames of the shortest loop."""
FILM_FRAMES, RATE = 100, 25
"""Fewest frames of the film, which repeats the loop, and frames a second."""

MARGIN, LONGEST, LETTERS = 28, 220, 22
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
    font = require("PIL.ImageFont").load_default(LETTERS)
    left, bottom = MARGIN, len(picture) - MARGIN
    draw.line((left, bottom, left + round(cells * cell), bottom), fill=ink, width=3)
    words = f"{cells} cell{'s' if cells > 1 else ''}"
    draw.text((left, bottom - 8), words, fill=ink, font=font, anchor="lb")
    return np.asarray(sheet)
