"""The picture by which other sites announce a creature."""

import numpy as np

from .raster import frame, theme_of
from .replay_file import Replay
from .strip import encoded

WIDTH, HEIGHT = 1200, 630
"""Pixels: what most sites cut pictures to."""

MOMENT = 2 / 3
"""Of the replay: by then it is under way, and its wake is there."""


def preview(replay: Replay, theme: str = "light") -> bytes:
    """One moment as a PNG of 1200 × 630 pixels, the creature in the middle.

    It is cut from the periodic box; where that would cut the creature, all of the box is
    shown.
    """
    number = round(MOMENT * (replay.frames - 1))
    wide, high = replay.size
    fills = max(WIDTH, HEIGHT * wide / high)
    reach = np.ptp(replay.positions[number], axis=0) * fills / wide
    width = fills if (reach < (WIDTH, HEIGHT)).all() else min(WIDTH, HEIGHT * wide / high)
    even = max(16, 2 * int(np.ceil(width / 2)))
    picture = frame(replay, number, width=even, theme=theme, follow=True)
    return encoded(_placed(picture, theme_of(theme).halo))


def _placed(picture: np.ndarray, around: tuple[int, int, int]) -> np.ndarray:
    """The middle of a picture in the middle of one of our size."""
    sheet = np.full((HEIGHT, WIDTH, 3), around, np.uint8)
    rows, columns = picture.shape[:2]
    high, wide = min(rows, HEIGHT), min(columns, WIDTH)
    top, left = (HEIGHT - high) // 2, (WIDTH - wide) // 2
    above, beside = (rows - high) // 2, (columns - wide) // 2
    cut = picture[above : above + high, beside : beside + wide]
    sheet[top : top + high, left : left + wide] = cut
    return sheet
