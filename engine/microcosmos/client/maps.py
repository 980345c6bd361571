"""The map of an archive, as a picture for a notebook."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

SIDE = 320
COLOURS = np.array(
    [(68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37)], float
)
"""Even samples of viridis (S. van der Walt and N. Smith, 2015; CC0)."""


def svg(
    axes: Sequence[Mapping[str, Any]], cell: np.ndarray, fitness: np.ndarray, caption: str
) -> str:
    """The filled cells of a grid of two axes, the first from left to right."""
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
    """From the least fitness, dark, to the best."""
    if not len(fitness):
        return []
    low, span = fitness.min(), np.ptp(fitness) or 1.0
    place = (fitness - low) / span * (len(COLOURS) - 1)
    channels = [np.interp(place, range(len(COLOURS)), channel) for channel in COLOURS.T]
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.rint(channels).astype(int).T]
