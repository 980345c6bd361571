"""The command `figure`: pictures, films, and figures for print."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.progress import Progress
from typer import Argument, Option
from typer.core import TyperGroup

from ..archive import creature_h5
from ..archive.beside import beside
from ..archive.file import HDF5, load
from ..archive.quantities import Real
from ..viz.figures import drawing, experiments
from ..viz.figures.verdicts import WORDS, verdicts
from ..viz.film import check, export
from ..viz.replay_file import read_replay
from .app import CACHE, app, console, fail, failing, with_options
from .modules import Modules, load_modules, prepare_engine

DEFAULT_COMMAND = "file"
"""The command that runs if none is named."""


class Figures(TyperGroup):
    """Take an argument that names no command as a file to draw."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        named = bool(args) and self.get_command(ctx, args[0]) is not None
        return super().resolve_command(ctx, args if named else [DEFAULT_COMMAND, *args])


figures = typer.Typer(
    cls=Figures,
    no_args_is_help=True,
    help="Draw pictures and films (`figure FILE OUT`), or figures for print with captions.",
)
app.add_typer(figures, name="figure")

File = Annotated[Path, Argument(exists=True, dir_okay=False, help="The archive file of a run.")]
Files = Annotated[
    list[Path], Argument(metavar="FILE... OUT", help="Archive files, then the figure to write.")
]
Out = Annotated[
    Path | None, Argument(help="A .pdf, .svg or .png file; default: a PDF beside FILE.")
]
Axes = Annotated[
    str | None,
    Option(help="One or two measures as a,b; default: the first two axes of the archive."),
]


REAL = ("length", "period")
"""Options of those figures alone whose captions state physical units."""


@contextmanager
def printed(
    width: Annotated[
        str, Option(help="single (85 mm), double (178 mm), or a width such as 120mm or 3.5in.")
    ] = "single",
    dpi: Annotated[int, Option(min=50, max=1200, help="Resolution of a PNG.")] = 300,
    caption: Annotated[
        bool, Option("--caption", help="Draw the caption under the figure.")
    ] = False,
    latex: Annotated[
        bool, Option("--latex", help="Write the caption for LaTeX to OUT.caption.tex.")
    ] = False,
    palette: Annotated[str, Option(help="viridis, cividis or magma.")] = "viridis",
    length: Annotated[
        str | None, Option(help="Real length of a body, such as 1mm, for units in the caption.")
    ] = None,
    period: Annotated[
        str | None, Option(help="Real period of a stroke, such as 0.5s; with --length.")
    ] = None,
) -> Iterator[drawing.Print]:
    with failing():
        real = Real.of(length, period)
        yield drawing.Print(width, dpi, caption, latex, palette, real)


@figures.command(DEFAULT_COMMAND)
def of_file(
    file: Annotated[Path, Argument(exists=True, dir_okay=False)],
    out: Annotated[
        Path, Argument(help=".png, .gif or .mp4 for a creature; .png, .svg or .pdf for a run.")
    ],
    audit: Annotated[
        Path | None,
        Option(
            exists=True,
            dir_okay=False,
            help="Report of `audit FILE --out`; a .png of the creature states its verdict.",
        ),
    ] = None,
    module: Modules = None,
) -> None:
    """Draw a picture or a film of a creature or its replay, or the figure of a run.

    `figure FILE OUT` without a command name runs this command.
    """
    load_modules(module)
    with failing(file):
        _draw(file, out, audit)
    print(out)


@figures.command()
@with_options(printed)
def archive(
    options: drawing.Print,
    file: File,
    out: Out = None,
    axes: Axes = None,
    colour: Annotated[str, Option(help="fitness, or a measure.")] = "fitness",
) -> None:
    """Draw the map of an archive: bins, or the cells of a tessellation."""
    show_paths(
        drawing.archive(file, _beside(file, out, "archive"), options, names_in(axes), colour)
    )


@figures.command()
@with_options(printed, width="double")
def sheet(
    options: drawing.Print,
    file: File,
    out: Out = None,
    axes: Axes = None,
    columns: Annotated[int, Option(help="Number of regions along the first axis.")] = 6,
    rows: Annotated[int, Option(help="Number of regions along the second axis.")] = 4,
    moments: Annotated[int, Option(help="Number of moments of each swimmer.")] = 5,
    audit: Annotated[
        list[Path] | None,
        Option(help="Report of `audit FILE --out` on an elite of the archive; repeatable."),
    ] = None,
    module: Modules = None,
) -> None:
    """Draw a contact sheet of gaits: the fittest swimmer of each region of the archive."""
    prepare_engine(module)
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("simulating elites", total=None)
        show_paths(
            drawing.contact(
                file,
                _beside(file, out, "sheet"),
                options,
                names_in(axes),
                (columns, rows),
                moments,
                lambda done, of: bar.update(task, completed=done, total=of),
                audit or (),
            )
        )


@figures.command()
@with_options(printed, omit=REAL, width="double")
def kinds(
    options: drawing.Print,
    files: Files,
    limit: Annotated[int, Option(min=1, max=100, help="Largest number of kinds.")] = 12,
    moments: Annotated[int, Option(min=2, max=32, help="Number of moments of a stroke.")] = 8,
) -> None:
    """Draw film strips of the kinds of motion in runs of one spec, the fittest first."""
    given, out = split(files)
    show_paths(drawing.kinds(given, out, options, limit, moments))


@figures.command()
@with_options(printed, omit=REAL, width="double")
def lineage(
    options: drawing.Print,
    file: File,
    out: Out = None,
    cell: Annotated[
        int | None,
        Option(help="Cell of the elite whose ancestors are drawn; default: the fittest."),
    ] = None,
) -> None:
    """Draw the pedigree of an archive's elites, and the ancestors of one of them."""
    show_paths(drawing.tree(file, _beside(file, out, "lineage"), options, cell))


def split(files: Sequence[Path]) -> tuple[list[Path], Path]:
    """Return the files to read, and the one to write."""
    *given, out = files
    if not given:
        fail(f"FILE... OUT needs an archive file and a figure to write; got only {out}")
    if missing := [str(file) for file in given if not file.is_file()]:
        fail(f"FILE must exist; not found: {', '.join(missing)}")
    return given, out


def show_paths(written: list[Path]) -> None:
    for path in written:
        print(path)


def _beside(file: Path, out: Path | None, name: str) -> Path:
    return out or beside(file, f".{name}.pdf")


def names_in(text: str | None) -> list[str] | None:
    return [name.strip() for name in text.split(",") if name.strip()] if text else None


def _draw(file: Path, out: Path, audit: Path | None) -> None:
    """A creature file is simulated first; the file of a run holds its table or its archive."""
    data = file.read_bytes()
    of_run = creature_h5.is_of_run(data)
    if audit and (of_run or out.suffix.lower() != ".png"):
        raise ValueError(f"`--audit` needs a .png of a creature, got {out} of {file}")
    trusted = verdicts([audit] if audit else [])
    if of_run and "archive" in load(data)[0]:
        drawing.archive(file, out, drawing.Print(), None, "fitness")
        return
    if of_run:
        experiments.save(experiments.of(data), out)
        return

    check(out)
    if data.startswith((b"{", HDF5)):
        from ..device import prepare
        from ..viz.replay import record

        prepare(cache=CACHE)
        data = record(creature_h5.read(data))
    export(data, out, **_noted(data, trusted))


def _noted(replay: bytes, trusted: Mapping[str, bool]) -> dict[str, str]:
    """Return the options of a strip that states the verdict, if one is given."""
    if not trusted:
        return {}
    name = read_replay(replay).header["creature"]
    if name not in trusted:
        audited = ", ".join(one[:12] for one in trusted)
        raise ValueError(f"`--audit` needs the audit of {name[:12]}, got that of {audited}")
    return {"note": WORDS[trusted[name]]}
