"""Figures for print from files to files: read, draw, caption, write."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Any, Concatenate, ParamSpec

import numpy as np

from ...quantities.real import Real, shown
from ...quantities.scales import of_archive
from ...statistics import Aggregates, Comparison, Group
from . import caption, compared, curves, lineage, maps, sheet, strips, style
from .reading import Archive, Described, grouped, read
from .style import millimetres, styled


@dataclass(frozen=True)
class Print:
    """The form of a printed figure."""

    width: str = "single"
    """`single`, `double`, or a length in mm, cm or in."""
    dpi: int = 300
    under: bool = False
    """Also write the caption under the figure."""
    tex: bool = False
    """Also write the caption for LaTeX."""
    palette: str = "viridis"
    real: Real | None = None
    """Real length of a body and period of a stroke, by which captions convert units."""

    def physical(self, data: bytes) -> str:
        """Return a sentence on physical units of an archive file's fittest elite, if asked for.

        Raises `ValueError` for a run without a fluid or a stroke.
        """
        if self.real is None:
            return ""
        scales, table = of_archive(data, self.real)
        speeds = table.get("speed_m_per_s")
        if speeds is None:
            return f" {scales[0].sentence()}"
        if np.isnan(speeds).all():
            return " No elite did two strokes: the real time of one is unknown."
        fastest = int(np.nanargmax(speeds))
        return (
            f" {scales[fastest].sentence()} The fastest swim {shown(speeds[fastest], 'm/s')}."
        )

    @property
    def mm(self) -> float:
        """Return the width in mm. Raises `ValueError` for a width of another form."""
        return millimetres(self.width)


P = ParamSpec("P")


def printed(
    draw: Callable[Concatenate[Print, P], tuple[Any, str]],
) -> Callable[Concatenate[Path, Print, P], list[Path]]:
    """Wrap a function that returns a figure and its caption: write both, return the paths."""

    @wraps(draw)
    def write(out: Path, options: Print, *args: P.args, **kwargs: P.kwargs) -> list[Path]:
        style.kind(out)  # A wrong ending is refused before minutes of simulation.
        with styled():
            figure, text = draw(options, *args, **kwargs)
            how = {"under": options.under, "tex": options.tex, "dpi": options.dpi}
            return style.publish(figure, out, text, **how)

    return write


@printed
def archive(options: Print, file: Path, axes: list[str] | None, colour: str):
    """Draw the map of an archive file."""
    return _map(options, open_archive(file), file.read_bytes(), axes, colour)


def picture(data: bytes, options: Print) -> bytes:
    """Return the map of an archive as a PNG.

    Raises `ValueError` without elites, and `ImportError` without matplotlib.
    """
    with styled():
        figure, text = _map(options, read(data), data, None, "fitness")
        return style.encoded(figure, ".png", caption=text, dpi=options.dpi)


def _map(
    options: Print, archive: Archive, data: bytes, axes: list[str] | None, colour: str
) -> tuple[Any, str]:
    look = {"colours": options.palette, "width": options.mm}
    figure = maps.archive(archive, axes=axes, colour=colour, **look)
    return figure, caption.of_archive(archive, axes) + options.physical(data)


@printed
def progress(options: Print, groups: Sequence[Group], names: Sequence[str], against: str):
    """Draw the curves with these names of groups of runs."""
    figure = curves.curves(groups, shown=names, against=against, width=options.mm)
    in_units = caption.curves_in_units(groups, names, options.real) if options.real else ""
    return figure, caption.of_curves(groups, names, against) + in_units


@printed
def boxes(options: Print, comparison: Comparison):
    """Draw every run of compared groups, with medians and quartiles."""
    figure = compared.boxes(comparison, width=options.mm)
    return figure, caption.of_boxes(comparison) + _in_units(comparison, options)


@printed
def parameter(options: Print, comparison: Comparison, path: str):
    """Draw measures of compared groups against a field of their specs."""
    figure = compared.parameter(comparison, path, width=options.mm)
    return figure, caption.of_parameter(comparison, path) + _in_units(comparison, options)


def _in_units(comparison: Comparison, options: Print) -> str:
    """Return a sentence on physical units of compared groups, if asked for."""
    return caption.comparison_in_units(comparison, options.real) if options.real else ""


@printed
def profiles(options: Print, aggregates: Aggregates, first: Described):
    """Draw performance profiles over tasks; `first` is a run whose spec the caption states."""
    return compared.profiles(aggregates, width=options.mm), caption.of_profiles(
        aggregates, first
    )


@printed
def contact(
    options: Print,
    file: Path,
    axes: list[str] | None,
    grid: tuple[int, int],
    moments: int,
    tell: Callable[[int, int], None] = lambda done, of: None,
    audits: Sequence[Path] = (),
):
    """Draw the contact sheet of an archive file; `grid` has columns and rows.

    `audits` are reports whose verdicts the sheet states, where it shows the creature.
    """
    trusted, data = sheet.verdicts(audits), file.read_bytes()
    found, columns, rows = open_archive(file), *grid
    plan = sheet.layout(found, axes=axes, columns=columns, rows=rows)
    cells = [int(found.cells[region.elite]) for region in plan.regions]
    moved = sheet.motions(data, cells, trusted, lambda done: tell(done, len(cells)))
    look = {"colours": options.palette, "width": options.mm}
    figure = sheet.sheet(found, plan, moved, moments=moments, **look)
    return figure, caption.of_sheet(found, plan, moved, moments) + options.physical(data)


@printed
def kinds(options: Print, files: Sequence[Path], most: int, moments: int):
    """Draw a stroke of an elite of each kind of motion in archive files, at most `most`.

    Raises `ValueError` for files whose specs differ in more than the seed.
    """
    runs, *others = grouped([open_archive(file) for file in files])
    if others:
        raise ValueError(
            f"`FILE` must differ in the seed alone, got {runs.name}; {others[0].name}."
        )
    shown = strips.exemplars([file.read_bytes() for file in files], most)
    look = {"colours": options.palette, "width": options.mm}
    figure = strips.strips(shown, moments=moments, **look)
    return figure, caption.of_strips(runs, shown, moments)


@printed
def tree(options: Print, file: Path, cell: int | None):
    """Draw the descent of an archive's elites, and of one of them."""
    archive = open_archive(file)
    related = lineage.family(archive)
    ancestors = len(related.ancestors([related.tips[archive.row(cell)]])) - 1
    look = {"colours": options.palette, "width": options.mm}
    figure = lineage.lineage(archive, cell=cell, **look)
    return figure, caption.of_lineage(archive, cell, ancestors)


def open_archive(file: Path) -> Archive:
    """Read the archive in a file; errors name the file."""
    try:
        return read(file.read_bytes())
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error
