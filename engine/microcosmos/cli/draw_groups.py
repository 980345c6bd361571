"""The commands `figure curves`, `box`, `parameter` and `profile`: figures of groups of runs."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

from ..viz.figures import drawing
from ..viz.figures.groups import Group, grouped
from .app import fail, with_options
from .draw import REAL, figures, names_in, printed, show_paths, split
from .groups import Measures, Resamples, Seed, read_groups

if TYPE_CHECKING:
    from ..statistics import Comparison

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
        found = [Group(one.name, one.runs) for one in read_groups(given)]
    else:
        paths, _ = split(list(map(Path, files)))
        found = grouped([drawing.open_archive(file) for file in paths])
    show_paths(drawing.progress(found, Path(out), options, names_in(shown) or [], against))


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
    show_paths(drawing.boxes(found, out, options))


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
    show_paths(drawing.parameter(found, field, out, options))


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
    from ..statistics import across
    from ..statistics.effects import Bootstrap

    given, out = _given(groups)
    found = read_groups(given)
    over_tasks = across(found, measure, task, Bootstrap(resamples, seed))
    show_paths(drawing.profiles(over_tasks, found[0].runs[0], out, options))


def _compared(
    texts: Sequence[str], measures: Sequence[str] | None, drawn: tuple[int, int]
) -> tuple["Comparison", Path]:
    from ..statistics import compare
    from ..statistics.effects import Bootstrap
    from ..statistics.measures import DEFAULT

    given, out = _given(texts)
    return compare(read_groups(given), measures or DEFAULT, Bootstrap(*drawn)), out


def _given(texts: Sequence[str]) -> tuple[list[str], Path]:
    """Return the groups to read, and the file to write."""
    *given, out = texts
    if not given:
        fail(f"groups and a figure to write are needed; got only {out}")
    return given, Path(out)
