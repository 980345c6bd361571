"""Curves as text, and as pictures for a notebook."""

from collections.abc import Sequence

DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
"""Bits of a Braille sign: by column, then from the top."""
EMPTY = 0x2800


def braille(values: Sequence[float | None], width: int, height: int) -> list[str]:
    """A curve in so many signs and lines; what is unknown leaves a gap."""
    columns, rows = 2 * width, 4 * height
    signs = [[EMPTY] * width for _ in range(height)]
    before: int | None = None
    for x, place in enumerate(_places(values, columns, rows)):
        if place is None:
            before = None
            continue
        low, high = sorted((place, place if before is None else before))
        for y in range(low, high + 1):
            if y != before or low == high:
                signs[height - 1 - y // 4][x // 2] |= DOTS[x % 2][3 - y % 4]
        before = place
    return ["".join(map(chr, line)) for line in signs]


def _places(values: Sequence[float | None], columns: int, rows: int) -> list[int | None]:
    """The row of each column, counted from below."""
    known = [value for value in values if value is not None]
    if not known:
        return []
    low, high = min(known), max(known)
    span = (high - low) or 1.0
    last = len(values) - 1
    taken = [values[round(x * last / (columns - 1))] for x in range(columns)]
    return [None if v is None else round((v - low) / span * (rows - 1)) for v in taken]


def polyline(values: Sequence[float | None], width: float, height: float) -> str:
    """The `points` of an SVG polyline; what is unknown is left out."""
    known = [(i, value) for i, value in enumerate(values) if value is not None]
    if not known:
        return ""
    low, high = min(v for _, v in known), max(v for _, v in known)
    span, last = (high - low) or 1.0, max(1, len(values) - 1)
    return " ".join(
        f"{i * width / last:.1f},{height - (value - low) / span * height:.1f}"
        for i, value in known
    )
