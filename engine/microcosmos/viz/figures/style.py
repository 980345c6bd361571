"""Sizes, letters and colours of figures, and their files with captions."""

import re
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from io import BytesIO
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np

from ...archive.atomic import write_whole
from ...latex import latex
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
FONT = "DejaVu Sans"  # Comes with matplotlib: the same letters everywhere.
RC: dict[str, Any] = {
    **{f"{axis}tick.{name}": value for axis in "xy" for name, value in TICK.items()},
    "font.family": [FONT],
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
    bar.ax.yaxis.label.set_parse_math(False)


def millimetres(width: str) -> float:
    """Return the width in mm of `single`, `double`, `85mm`, `3.5in`, or a number of mm."""
    match = re.fullmatch(r"(\d+\.?\d*|\.\d+) *(mm|cm|in|)", width.strip())
    unit = {"cm": 10.0, "in": INCH}.get(match[2], 1.0) if match else 0.0
    size = COLUMNS.get(width) or (float(match[1]) * unit if match else 0.0)
    if not 20 <= size <= 1000:
        raise ValueError(
            f"`width` must be single ({COLUMNS['single']:g} mm), double "
            f"({COLUMNS['double']:g} mm), or 20 to 1000 mm as in 120mm or 3.5in; got {width!r}."
        )
    return size


def blank(width: float, height: float) -> Any:
    """Return a figure of a size in mm, without matplotlib's global state."""
    # Not `pyplot`, which keeps figures and a backend for the whole process
    # (test_figures_leave_matplotlibs_global_state_alone).
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


def plain(panel: Any, axis: str = "both") -> None:
    """Draw a fine grid behind the lines, and no lines above and on the right.

    The axes are labelled by words, which may have dollars.
    """
    for one in (panel.xaxis, panel.yaxis):
        one.label.set_parse_math(False)
    panel.set_axisbelow(True)
    panel.grid(color=GREY, alpha=0.18, lw=0.4, axis=axis)
    panel.spines[["top", "right"]].set_visible(False)


def drawable(name: str) -> str:
    """Return the name of a group for a figure. Raises `ValueError` for a letter that the font
    lacks, which would be an empty box."""
    fonts = require("matplotlib.font_manager")
    font = fonts.get_font(fonts.findfont(FONT))
    for letter in name:
        if not letter.isspace() and not font.get_char_index(ord(letter)):
            raise ValueError(
                f"names of groups need letters that the font {FONT} has; got {letter!r} in "
                f"{name!r}"
            )
    # Legends leave out labels that begin with `_`; the space before it has no width.
    return f"\u200b{name}" if name.startswith("_") else name


def legend_of_groups(where: Any, *entries: Any, **place: Any) -> None:
    """Draw a legend of names, whose dollars are no mathematics."""
    for text in where.legend(*entries, frameon=False, **place).get_texts():
        text.set_parse_math(False)


def legend_above(figure: Any, panel: Any, entries: int) -> None:
    """Explain the groups of a panel above all panels."""
    place = {"loc": "outside upper center", "ncols": min(3, entries)}
    legend_of_groups(figure, *panel.get_legend_handles_labels(), **place)


def legend_below(figure: Any, entries: tuple[list, list], columns: int) -> None:
    place = {"loc": "outside lower center", "ncols": columns}
    figure.legend(*entries, **place, frameon=False, fontsize=9)


def require_columns(rows: Sequence[Row], names: Sequence[str]) -> None:
    if not rows:
        raise ValueError("`rows` must have at least one row, got none.")
    for number, row in enumerate(rows):
        if lacking := [name for name in names if name not in row]:
            raise ValueError(f"`rows` must have {', '.join(lacking)}; row {number} does not.")


LETTER, LINE = 1.22, 2.8
"""Mean width and height of a letter of a caption, in mm."""

TITLE = "Microcosmos"

KINDS = {
    ".pdf": ("Subject", "CreationDate", "Creator", "Producer"),
    ".svg": ("Description", "Date", "Creator"),
    ".png": ("Description", "Software"),
}
"""Metadata of each kind of file: the caption's field, and those that differ by machine."""


def kind(path: Path) -> str:
    """Return the ending of a figure's name. Raises `ValueError` for any other."""
    if path.suffix.lower() not in KINDS:
        raise ValueError(f"`OUT` must end in {', '.join(KINDS)}; got {str(path)!r}.")
    return path.suffix.lower()


def encoded(figure: Any, suffix: str, *, caption: str = "", dpi: int = 300) -> bytes:
    """Return the bytes of a figure, with its caption in the metadata."""
    field, *omitted = KINDS[suffix]
    # None leaves a field out: times and versions would change the bytes
    # (test_equal_figures_are_equal_files).
    metadata = dict.fromkeys(omitted) | {"Title": TITLE} | ({field: caption} if caption else {})
    out = BytesIO()
    # Without a salt, matplotlib draws the ids in an SVG file at random.
    with require("matplotlib").rc_context({"svg.hashsalt": "microcosmos"}):
        figure.savefig(out, format=suffix[1:], dpi=dpi, metadata=metadata)
    return out.getvalue()


def publish(
    figure: Any,
    path: Path,
    caption: str,
    *,
    under: bool = False,
    tex: bool = False,
    dpi: int = 300,
) -> list[Path]:
    """Write a figure and, beside it, its caption; return the paths.

    `under` puts the caption below the figure too, `tex` writes it for LaTeX as well.
    """
    suffix = kind(path)
    if under:
        below(figure, caption)
    write_whole(path, encoded(figure, suffix, caption=caption, dpi=dpi))
    captions = {path.with_suffix(".caption.txt"): caption}
    if tex:
        captions[path.with_suffix(".caption.tex")] = latex(caption)
    for beside, text in captions.items():
        write_whole(beside, f"{text}\n".encode())
    return [path, *captions]


def below(figure: Any, caption: str) -> None:
    """Add the caption under a figure, which grows by its height."""
    width, height = figure.get_size_inches()
    lines = wrap(caption, int(width * INCH / LETTER))
    figure.set_size_inches(width, height + (len(lines) + 1) * LINE / INCH)
    look = {"fontsize": 6, "linespacing": 1.3, "parse_math": False}  # Names may have dollars.
    figure.supxlabel("\n".join(lines), x=0.01, ha="left", **look)
