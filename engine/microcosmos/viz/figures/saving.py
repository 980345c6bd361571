"""Figures as files, with captions: the same figure gives the same bytes."""

from io import BytesIO
from pathlib import Path
from textwrap import wrap
from typing import Any

from ...archive.atomic import write_whole
from ...latex import latex
from ...optional import require
from .style import INCH

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
    metadata = dict.fromkeys(omitted) | {"Title": TITLE} | ({field: caption} if caption else {})
    out = BytesIO()
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
    figure.supxlabel("\n".join(lines), x=0.01, ha="left", fontsize=6, linespacing=1.3)
