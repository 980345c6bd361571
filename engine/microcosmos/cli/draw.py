"""The commands `figure`: pictures, films, and figures of runs and of groups for print."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer
from rich.progress import Progress
from typer import Argument, Option
from typer.core import TyperGroup

from ..archive import creature_h5
from ..archive.file import HDF5, load
from ..archive.file_names import beside
from ..quantities.real import Real
from ..statistics import Comparison, across, compare
from ..statistics.effects import Bootstrap
from ..statistics.groups import refuse_mixed
from ..statistics.measures import DEFAULT
from ..viz.figures import drawing, experiments
from ..viz.figures.reading import grouped
from ..viz.figures.sheet import WORDS, verdicts
from ..viz.film import check, export
from ..viz.replay_file import read_replay
from .app import (
    CACHE,
    Modules,
    app,
    console,
    fail,
    failing,
    load_modules,
    prepare_engine,
    refuse_input,
    with_options,
)
from .groups import Measures, Resamples, Seed, read_groups

T = TypeVar("T", str, Path)

DEFAULT_COMMAND = "file"
"""The command that runs if none is named."""


class Figures(TyperGroup):
    """Take an argument that names no command as a file to draw."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        # `figure FILE OUT` works without the name of a command (docs/figures.md).
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
"""Options of the figures whose captions state physical units."""


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
    refuse_input(out, file, *filter(None, [audit]), option="OUT")
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
        drawing.archive(_beside(file, out, "archive"), options, file, names_in(axes), colour)
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
    # The swimmers are simulated, perhaps with a plug-in (docs/figures.md).
    prepare_engine(module)
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("simulating elites", total=None)
        show_paths(
            drawing.contact(
                _beside(file, out, "sheet"),
                options,
                file,
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
    given, out = archive_files(files)
    show_paths(drawing.kinds(out, options, given, limit, moments))


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
    show_paths(drawing.tree(_beside(file, out, "lineage"), options, file, cell))


def archive_files(files: Sequence[Path]) -> tuple[list[Path], Path]:
    """Return the files to read, and the one to write."""
    given, out = split(files)
    if missing := [str(file) for file in given if not file.exists()]:
        fail(f"FILE must exist; not found: {', '.join(missing)}")
    if others := [str(file) for file in given if not file.is_file()]:
        fail(f"FILE must be a file, no folder or pipe; got {', '.join(others)}")
    return given, Path(out)


def split(given: Sequence[T]) -> tuple[list[T], T]:
    """Return what is read, and the file to write."""
    *sources, out = given
    if not sources:
        fail(f"FILE... OUT needs files or groups, and a figure to write; got only {out}")
    return sources, out


def show_paths(written: list[Path]) -> None:
    for path in written:
        print(path)


def _beside(file: Path, out: Path | None, name: str) -> Path:
    return out or beside(file, f".{name}.pdf")


def names_in(text: str | None) -> list[str] | None:
    return [name.strip() for name in text.split(",") if name.strip()] if text else None


def _draw(file: Path, out: Path, audit: Path | None) -> None:
    """Draw a creature file, which is simulated first, or the table or archive of a run."""
    data = file.read_bytes()
    of_run = creature_h5.is_of_run(data)
    if audit and (of_run or out.suffix.lower() != ".png"):
        raise ValueError(f"`--audit` needs a .png of a creature, got {out} of {file}")
    trusted = verdicts([audit] if audit else [])
    if of_run and "archive" in load(data)[0]:
        drawing.archive(out, drawing.Print(), file, None, "fitness")
        return
    if of_run:
        experiments.save(experiments.figure_of(data), out)
        return

    check(out)
    # A creature file, in either form; a replay is drawn without a simulation.
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


GroupsAndOut = Annotated[
    list[str],
    Argument(
        metavar="[NAME=]RUN,RUN... OUT",
        help="Groups as for `compare`, then a .pdf, .svg or .png file.",
    ),
]


@figures.command()
@with_options(printed, omit=("palette",), width="double")
def curves(
    options: drawing.Print,
    files: Annotated[
        list[str],
        Argument(metavar="FILE... OUT", help="Archive files, or groups as NAME=FILE,FILE..."),
    ],
    shown: Annotated[
        str, Option(help="Some of qd_score, coverage, best, mean, evaluations …, with commas.")
    ] = "best,coverage,qd_score",
    against: Annotated[str, Option(help="evaluations or generations.")] = "evaluations",
) -> None:
    """Draw the curves of runs: the median and a band over the seeds of each spec or group."""
    *given, out = files
    if any("=" in text for text in given):
        groups = read_groups(given)
        refuse_mixed(groups)  # Unlike in `compare`, runs may be unfinished.
    else:
        paths, _ = archive_files(list(map(Path, files)))
        groups = grouped([drawing.open_archive(file) for file in paths])
    show_paths(drawing.progress(Path(out), options, groups, names_in(shown) or [], against))


@figures.command()
@with_options(printed, omit=("palette",), width="double")
def box(
    options: drawing.Print,
    groups: GroupsAndOut,
    measure: Measures = None,
    resamples: Annotated[int, Resamples] = 9999,
    seed: Annotated[int, Seed] = 0,
) -> None:
    """Draw every run of groups as a point, with medians and quartiles; tests in the caption."""
    found, out = _compared(groups, measure, (resamples, seed))
    show_paths(drawing.boxes(out, options, found))


@figures.command()
@with_options(printed, omit=("palette",), width="double")
def parameter(
    options: drawing.Print,
    field: Annotated[str, Argument(help="A field of the spec, such as world.viscosity.")],
    groups: GroupsAndOut,
    measure: Measures = None,
    resamples: Annotated[int, Resamples] = 9999,
    seed: Annotated[int, Seed] = 0,
) -> None:
    """Draw measures against a field in which specs differ, over the seeds of each spec."""
    found, out = _compared(groups, measure, (resamples, seed))
    show_paths(drawing.parameter(out, options, found, field))


@figures.command()
@with_options(printed, omit=("palette", *REAL))
def profile(
    options: drawing.Print,
    groups: GroupsAndOut,
    task: Annotated[
        list[str], Option(metavar="FIELD", help="Field that tells tasks apart; repeatable.")
    ],
    measure: Annotated[str, Option(help="A curve, such as qd_score.")] = "qd_score",
    resamples: Annotated[int, Resamples] = 9999,
    seed: Annotated[int, Seed] = 0,
) -> None:
    """Draw the share of runs above a score over several tasks, with bands."""
    given, out = split(groups)
    groups_of_runs = read_groups(given)
    over_tasks = across(groups_of_runs, measure, task, Bootstrap(resamples, seed))
    show_paths(drawing.profiles(Path(out), options, over_tasks, groups_of_runs[0].runs[0]))


def _compared(
    texts: Sequence[str], measures: Sequence[str] | None, drawn: tuple[int, int]
) -> tuple[Comparison, Path]:
    given, out = split(texts)
    return compare(read_groups(given), measures or DEFAULT, Bootstrap(*drawn)), Path(out)
