"""What figures share: an empty one, colours and marks, and the check of their rows."""

from collections.abc import Mapping, Sequence
from typing import Any

from ...optional import require

Row = Mapping[str, Any]
"""Names and values, flat, as an experiment reports them."""

COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#000000")
"""Okabe and Ito's, which colour-blind people tell apart."""

MARKERS = ("o", "s", "^", "D", "v", "P", "*")
GREY = "#5f6b73"


def blank(width: float, height: float) -> Any:
    """A figure of inches, drawn without matplotlib's global state."""
    return require("matplotlib.figure").Figure(figsize=(width, height), layout="constrained")


def look(number: int) -> dict[str, Any]:
    """Colour and mark of the line with this number."""
    return {"color": COLOURS[number % 7], "marker": MARKERS[number % 7]}


def tidy(panel: Any) -> None:
    """A faint grid behind the lines, and no box around them."""
    panel.set_axisbelow(True)
    panel.grid(color=GREY, alpha=0.18, lw=0.6)
    for side in ("left", "right", "top", "bottom"):
        panel.spines[side].set_color(GREY)
    panel.tick_params(colors="#333b40", which="both", labelsize=9)


def refuse_lacking(rows: Sequence[Row], names: Sequence[str]) -> None:
    if not rows:
        raise ValueError("`rows` must have at least one row, got none.")
    for number, row in enumerate(rows):
        if lacking := [name for name in names if name not in row]:
            raise ValueError(f"`rows` must have {', '.join(lacking)}; row {number} has not.")
