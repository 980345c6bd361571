"""Figures as files: the same figure gives the same bytes."""

from io import BytesIO
from pathlib import Path
from textwrap import wrap
from typing import Any

from ...archive.atomic import write_whole
from .style import INCH
from .tex import latex

LETTER, LINE = 1.22, 2.8
"""How wide and how high a letter of a caption is on average, in mm."""

TITLE = "Microcosmos"

KINDS = {
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    ".svg": {"Date": None, "Creator": None},
    ".png": {"Software": None},
}
"""Kinds of file, and what matplotlib would write into each that is another elsewhere."""

TOLD = {".pdf": "Subject", ".svg": "Description", ".png": "Description"}
"""Where a caption stands in each."""


def kind(path: Path) -> str:
    """The ending of a figure's name. Raises `ValueError` for any other."""
    if path.suffix.lower() not in KINDS:
        raise ValueError(f"`OUT` must end in {', '.join(KINDS)}; got {str(path)!r}.")
    return path.suffix.lower()


def encoded(figure: Any, suffix: str, *, caption: str = "", dpi: int = 300) -> bytes:
    """The bytes of a figure; its caption is among what the file says of itself."""
    told = {**KINDS[suffix], "Title": TITLE, **({TOLD[suffix]: caption} if caption else {})}
    out = BytesIO()
    figure.savefig(out, format=suffix[1:], dpi=dpi, metadata=told)
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
    """Writes a figure and, beside it, its caption, and says what was written.

    `under` puts the caption below the figure too, `tex` writes it for LaTeX as well.
    """
    suffix = kind(path)
    if under:
        below(figure, caption)
    write_whole(path, encoded(figure, suffix, caption=caption, dpi=dpi))
    told = {path.with_suffix(".caption.txt"): caption}
    if tex:
        told[path.with_suffix(".caption.tex")] = latex(caption)
    for beside, text in told.items():
        write_whole(beside, f"{text}\n".encode())
    return [path, *told]


def below(figure: Any, caption: str) -> None:
    """The caption under a figure, which grows by its height."""
    width, height = figure.get_size_inches()
    lines = wrap(caption, int(width * INCH / LETTER))
    figure.set_size_inches(width, height + (len(lines) + 1) * LINE / INCH)
    figure.supxlabel("\n".join(lines), x=0.01, ha="left", fontsize=6, linespacing=1.3)
