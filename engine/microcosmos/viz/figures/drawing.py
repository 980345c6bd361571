"""Figures for print from files to files: read, draw, caption, write."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ...archive.physical import of_archive
from ...archive.quantities import Real, shown
from . import caption, curves, groups, lineage, maps, saving, sheet, strips
from .lineage import family
from .reading import Archive, Described, read
from .style import millimetres, styled
from .verdicts import verdicts

if TYPE_CHECKING:
    from ...statistics import Aggregates, Comparison


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
        fastest = 0 if speeds is None else int(speeds.argmax())
        reached = (
            "" if speeds is None else f" The fastest swim {shown(speeds[fastest], 'm/s')}."
        )
        return f" {scales[fastest].sentence()}{reached}"

    def publish(self, figure, out: Path, text: str) -> list[Path]:
        """Write a figure with its caption; return the paths."""
        return saving.publish(figure, out, text, under=self.under, tex=self.tex, dpi=self.dpi)


def archive(
    file: Path, out: Path, options: Print, axes: list[str] | None, colour: str
) -> list[Path]:
    """Draw the map of an archive file."""
    saving.kind(out)
    found = open_archive(file)
    with styled():
        width, palette = millimetres(options.width), options.palette
        figure = maps.archive(found, axes=axes, colour=colour, colours=palette, width=width)
        text = caption.of_archive(found, axes) + options.physical(file.read_bytes())
        return options.publish(figure, out, text)


def progress(
    found: Sequence[groups.Group],
    out: Path,
    options: Print,
    names: Sequence[str],
    against: str,
) -> list[Path]:
    """Draw the curves with these names of groups of runs."""
    from . import real  # Loads SciPy.

    saving.kind(out)
    with styled():
        width = millimetres(options.width)
        figure = curves.curves(found, shown=names, against=against, width=width)
        text = caption.of_curves(found, names)
        if options.real is not None:
            text += real.of_curves(found, names, options.real)
        return options.publish(figure, out, text)


def boxes(found: "Comparison", out: Path, options: Print) -> list[Path]:
    """Draw every run of compared groups, with medians and quartiles."""
    from . import compared, compared_caption  # Load SciPy.

    saving.kind(out)
    with styled():
        figure = compared.boxes(found, width=millimetres(options.width))
        text = compared_caption.of_boxes(found) + _in_units(found, options)
        return options.publish(figure, out, text)


def parameter(found: "Comparison", path: str, out: Path, options: Print) -> list[Path]:
    """Draw measures of compared groups against a field of their specs."""
    from . import compared, compared_caption  # Load SciPy.

    saving.kind(out)
    with styled():
        figure = compared.parameter(found, path, width=millimetres(options.width))
        text = compared_caption.of_parameter(found, path) + _in_units(found, options)
        return options.publish(figure, out, text)


def _in_units(found: "Comparison", options: Print) -> str:
    """Return a sentence on physical units of compared groups, if asked for."""
    from . import real  # Loads SciPy.

    return "" if options.real is None else real.of_comparison(found, options.real)


def profiles(found: "Aggregates", first: Described, out: Path, options: Print) -> list[Path]:
    """Draw performance profiles over tasks; `first` is a run whose spec the caption states."""
    from . import compared, compared_caption  # Load SciPy.

    saving.kind(out)
    with styled():
        figure = compared.profiles(found, width=millimetres(options.width))
        return options.publish(figure, out, compared_caption.of_profiles(found, first))


def contact(
    file: Path,
    out: Path,
    options: Print,
    axes: list[str] | None,
    grid: tuple[int, int],
    moments: int,
    tell: Callable[[int, int], None] = lambda done, of: None,
    audits: Sequence[Path] = (),
) -> list[Path]:
    """Draw the contact sheet of an archive file; `grid` has columns and rows.

    `audits` are reports whose verdicts the sheet states, where it shows the creature.
    """
    from . import motions  # Loads JAX.

    saving.kind(out)
    trusted = verdicts(audits)
    found, columns, rows = open_archive(file), *grid
    plan = sheet.layout(found, axes=axes, columns=columns, rows=rows)
    cells = [int(found.cells[region.elite]) for region in plan.regions]
    moved = motions.motions(
        file.read_bytes(), cells, trusted, lambda done: tell(done, len(cells))
    )
    with styled():
        width, palette = millimetres(options.width), options.palette
        figure = sheet.sheet(found, plan, moved, moments=moments, colours=palette, width=width)
        text = caption.of_sheet(found, plan, moved, moments)
        return options.publish(figure, out, text + options.physical(file.read_bytes()))


def kinds(
    files: Sequence[Path], out: Path, options: Print, most: int, moments: int
) -> list[Path]:
    """Draw a stroke of an elite of each kind of motion in archive files, at most `most`.

    Raises `ValueError` for files whose specs differ in more than the seed.
    """
    saving.kind(out)
    runs, *others = groups.grouped([open_archive(file) for file in files])
    if others:
        raise ValueError(
            f"`FILE` must differ in the seed alone, got {runs.label}; {others[0].label}."
        )
    shown = strips.exemplars([file.read_bytes() for file in files], most)
    with styled():
        width, palette = millimetres(options.width), options.palette
        figure = strips.strips(shown, moments=moments, colours=palette, width=width)
        return options.publish(figure, out, caption.of_strips(runs, shown, moments))


def tree(file: Path, out: Path, options: Print, cell: int | None) -> list[Path]:
    """Draw the descent of an archive's elites, and of one of them."""
    saving.kind(out)
    found = open_archive(file)
    related = family(found)
    ancestors = len(related.ancestors([related.tips[found.row(cell)]])) - 1
    with styled():
        width = millimetres(options.width)
        figure = lineage.lineage(found, cell=cell, colours=options.palette, width=width)
        return options.publish(figure, out, caption.of_lineage(found, cell, ancestors))


def open_archive(file: Path) -> Archive:
    """Read the archive in a file; errors name the file."""
    try:
        return read(file.read_bytes())
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error
