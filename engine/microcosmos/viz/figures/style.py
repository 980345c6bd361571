"""Sizes, letters and colours of figures."""

import re
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any

import numpy as np

from ...optional import require

INCH = 25.4
"""Millimetres per inch."""

COLUMNS = {"single": 85.0, "double": 178.0}
"""Widths of a column and of a page in most journals, in mm."""

Row = Mapping[str, Any]
"""Flat names and values of an experiment's result."""

COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#000000")
"""Colours of Okabe and Ito, which colour-blind people tell apart."""

MARKERS = ("o", "s", "^", "D", "v", "P", "*")

INK, GREY, PALE = "#1b2226", "#5f6b73", "#c9d0d4"
EMPTY = "#eef1f2"
"""Colour of empty cells."""

TICK = {
    "labelsize": 6.0,
    "color": GREY,
    "labelcolor": INK,
    "major.width": 0.5,
    "minor.width": 0.4,
    "major.size": 2.5,
    "minor.size": 1.5,
    "major.pad": 2.0,
}
RC: dict[str, Any] = {
    **{f"{axis}tick.{name}": value for axis in "xy" for name, value in TICK.items()},
    "font.family": ["DejaVu Sans"],  # Comes with matplotlib: the same letters everywhere.
    "mathtext.fontset": "dejavusans",
    "font.size": 7.0,
    "axes.titlesize": 7.0,
    "axes.labelsize": 7.0,
    "legend.fontsize": 6.0,
    "axes.linewidth": 0.5,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "text.color": INK,
    "axes.labelpad": 2.5,
    "lines.linewidth": 1.0,
    "pdf.fonttype": 42,  # TrueType, which journals ask for.
}

SAMPLES = {
    "viridis": "44015448186a472d7b4240863b528b33638d2c728e26828e21918c1fa08828ae803fbc735ec96284d44baddc30d8e219fde725",  # noqa: E501
    "cividis": "00224e002e6a1a386f32436d434e6c535a6d61656f6f70737d7c788c88789b9476aba072bcae6ccdbb63dec958f0d846fee838",  # noqa: E501
    "magma": "1a10422f11634710785d177f7521818b2981a1307eb83779cf4070e34e65f2625df97b5dfd9668feb078feca8dfde3a5fcfdbf",  # noqa: E501
}
"""The page's colours from dark to light (`web/src/ui/colours.ts`): perceptually uniform, to
most colour-blind people too."""


def styled() -> AbstractContextManager:
    """Apply matplotlib's settings for print, while a figure is made and saved."""
    return require("matplotlib").rc_context(RC)


def palette(name: str) -> Any:
    """Return a colour map from 0, dark, to 1, light."""
    if name not in SAMPLES:
        raise ValueError(f"`palette` must be one of {', '.join(SAMPLES)}, got {name!r}.")
    colours = ["#" + colour for colour in re.findall("......", SAMPLES[name])]
    return require("matplotlib.colors").LinearSegmentedColormap.from_list(name, colours)


def shades(values: np.ndarray, colours: str) -> Any:
    """Return the colours of values from their least to their greatest."""
    return require("matplotlib.cm").ScalarMappable(linear_scale(values), palette(colours))


def linear_scale(values: np.ndarray) -> Any:
    """Return the scale from the least to the greatest value."""
    low, high = float(values.min()), float(values.max())
    return require("matplotlib.colors").Normalize(low, high if high > low else low + 1)


def colour_bar(panel: Any, drawn: Any, label: str, *, pad: float, aspect: int) -> None:
    bar = panel.figure.colorbar(drawn, ax=panel, label=label, pad=pad, aspect=aspect)
    bar.outline.set_linewidth(0.5)


def millimetres(width: str) -> float:
    """Return the width in mm of `single`, `double`, `85mm`, `3.5in`, or a number of mm."""
    found = re.fullmatch(r"(\d+\.?\d*|\.\d+) *(mm|cm|in|)", width.strip())
    unit = {"cm": 10.0, "in": INCH}.get(found[2], 1.0) if found else 0.0
    size = COLUMNS.get(width) or (float(found[1]) * unit if found else 0.0)
    if not 20 <= size <= 1000:
        raise ValueError(
            f"`width` must be single ({COLUMNS['single']:g} mm), double "
            f"({COLUMNS['double']:g} mm), or 20 to 1000 mm as in 120mm or 3.5in; got {width!r}."
        )
    return size


def blank(width: float, height: float) -> Any:
    """Return a figure of a size in mm, without matplotlib's global state."""
    figure = require("matplotlib.figure").Figure((width / INCH, height / INCH))
    figure.set_layout_engine("constrained", w_pad=0.02, h_pad=0.02, wspace=0.03, hspace=0.03)
    return figure


def lettered(panels: Sequence[Any]) -> None:
    """Write (a), (b) ... over several panels."""
    if len(panels) > 1:
        for number, panel in enumerate(panels):
            panel.set_title(f"({chr(97 + number)})", loc="left", fontweight="bold")


def look(number: int) -> dict[str, Any]:
    """Return colour and mark of the line with this number."""
    return {"color": COLOURS[number % 7], "marker": MARKERS[number % 7]}


def tidy(panel: Any) -> None:
    """Draw a faint grid behind the lines, and no box around them."""
    panel.set_axisbelow(True)
    panel.grid(color=GREY, alpha=0.18, lw=0.6)
    panel.spines[:].set_color(GREY)
    panel.tick_params(colors="#333b40", which="both", labelsize=9)


def legend_below(figure: Any, entries: tuple[list, list], columns: int) -> None:
    place = {"loc": "outside lower center", "ncols": columns}
    figure.legend(*entries, **place, frameon=False, fontsize=9)


def require_columns(rows: Sequence[Row], names: Sequence[str]) -> None:
    if not rows:
        raise ValueError("`rows` must have at least one row, got none.")
    for number, row in enumerate(rows):
        if lacking := [name for name in names if name not in row]:
            raise ValueError(f"`rows` must have {', '.join(lacking)}; row {number} does not.")
