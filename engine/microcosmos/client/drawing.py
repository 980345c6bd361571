"""Curves as text, and curves and archive maps as SVG."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
"""Bits of a Braille sign: by column, then from the top."""
EMPTY = 0x2800
SIDE = 320
"""Pixels of a map."""
VIRIDIS = np.array(
    [(68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37)], float
)
"""Even samples of viridis (S. van der Walt and N. Smith, 2015; CC0)."""


def braille(values: Sequence[float | None], width: int, height: int) -> list[str]:
    """Draw a curve in `height` lines of `width` Braille signs; unknown values leave gaps."""
    columns, rows = 2 * width, 4 * height
    signs = [[EMPTY] * width for _ in range(height)]
    before: int | None = None
    shares = _shares(values)
    for x in range(columns if shares else 0):
        share = shares[round(x * (len(shares) - 1) / (columns - 1))]
        if share is None:
            before = None
            continue
        place = round(share * (rows - 1))
        low, high = sorted((place, place if before is None else before))
        for y in range(low, high + 1):
            if y != before or low == high:
                signs[height - 1 - y // 4][x // 2] |= DOTS[x % 2][3 - y % 4]
        before = place
    return ["".join(map(chr, line)) for line in signs]


def _shares(values: Sequence[float | None]) -> list[float | None]:
    """Return values from 0 for the least to 1 for the largest; none without values."""
    known = [value for value in values if value is not None]
    if not known:
        return []
    # A flat curve has no span to divide by.
    low, span = min(known), (max(known) - min(known)) or 1.0
    return [None if value is None else (value - low) / span for value in values]


def polyline(values: Sequence[float | None], width: float, height: float) -> str:
    """Return the `points` of an SVG polyline, without unknown values."""
    last = max(1, len(values) - 1)
    return " ".join(
        f"{i * width / last:.1f},{height - place * height:.1f}"
        for i, place in enumerate(_shares(values))
        if place is not None
    )


def archive_map(
    axes: Sequence[Mapping[str, Any]], cell: np.ndarray, fitness: np.ndarray, caption: str
) -> str:
    """Draw the filled cells of a grid of two axes, the first from left to right."""
    columns, rows = axes[0]["bins"], axes[1]["bins"]
    wide, high = SIDE / columns, SIDE / rows
    squares = "".join(
        f'<rect x="{number // rows * wide:.2f}" y="{SIDE - (number % rows + 1) * high:.2f}" '
        f'width="{wide:.2f}" height="{high:.2f}" fill="{colour}"/>'
        for number, colour in zip(cell.tolist(), colours(fitness), strict=True)
    )
    names = f"{escape(axes[0]['name'])} →, {escape(axes[1]['name'])} ↑"
    return (
        f'<figure style="margin:4px 0"><svg width="{SIDE}" height="{SIDE}" role="img" '
        f'aria-label="{escape(caption)}" style="border:1px solid #8888">{squares}</svg>'
        f"<figcaption>{escape(caption)}<br>{names}</figcaption></figure>"
    )


def colours(fitness: np.ndarray) -> list[str]:
    """Return a colour for each fitness, from dark for the least to bright for the best."""
    if not len(fitness):
        return []
    low, span = fitness.min(), np.ptp(fitness) or 1.0
    place = (fitness - low) / span * (len(VIRIDIS) - 1)
    channels = [np.interp(place, range(len(VIRIDIS)), channel) for channel in VIRIDIS.T]
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.rint(channels).astype(int).T]
