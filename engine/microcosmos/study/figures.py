"""The figures of a study, with captions that name groups, runs and tests."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..archive.file import load
from ..archive.poses import streams
from ..statistics import RunRecord
from ..statistics.measures import Measure
from ..viz.figures import caption, compared, curves, sheet, strips, style
from ..viz.figures.reading import read
from ..viz.figures.style import COLUMNS, INCH, styled
from .document import Figure
from .results import Compare, Results

FORMATS = (".svg", ".pdf")
PART_OF_PAGE = 130.0
"""Width in mm beyond which a figure needs the whole width."""
MOMENTS = 8


@dataclass(frozen=True)
class Picture:
    """A figure as files, with its caption and the ids of the runs that it shows."""

    kind: str
    of: str
    """The comparison."""
    svg: bytes
    pdf: bytes
    caption: str
    runs: tuple[str, ...]
    wide: bool
    """True for a figure as wide as a page."""


def draw(results: Results, tell: Callable[[int], None] = lambda done: None) -> list[Picture]:
    """Draw the figures of a study. Raises `ValueError` where one cannot be drawn."""
    pictures = []
    for number, figure in enumerate(results.plan.study.figures):
        name, _ = results.plan.study.comparison_of(figure)
        try:
            pictures.append(_picture(results, figure, results.comparisons[name]))
        except ValueError as error:
            raise ValueError(f"figures.{number} ({figure.kind}): {error}") from error
        tell(number + 1)
    return pictures


def files(pictures: Sequence[Picture]) -> Iterator[tuple[str, bytes]]:
    """Yield every figure as SVG and PDF, and its caption, by the names of the files."""
    for number, one in enumerate(pictures, 1):
        name = f"{number}-{one.kind}"
        yield f"{name}.svg", one.svg
        yield f"{name}.pdf", one.pdf
        yield f"{name}.caption.txt", f"{one.caption}\n".encode()


def _picture(results: Results, figure: Figure, of: Compare) -> Picture:
    ids = tuple(run.name for group in of.groups for run in group.runs)
    with styled():
        drawn, text, shown = _DRAW[figure.kind](results, figure, of)
        # Both from one drawing, within the settings of print.
        svg, pdf = (style.encoded(drawn, suffix, caption=text) for suffix in FORMATS)
    wide = drawn.get_figwidth() * INCH > PART_OF_PAGE
    return Picture(figure.kind, of.name, svg, pdf, text, shown or ids, wide)


Made = tuple[Any, str, tuple[str, ...]]
"""A figure, its caption, and the runs that it shows; empty for all of the comparison."""


def _curves(results: Results, figure: Figure, of: Compare) -> Made:
    drawn = curves.curves(of.groups, shown=figure.shown)
    return drawn, caption.of_curves(of.groups, figure.shown), ()


def _box(results: Results, figure: Figure, of: Compare) -> Made:
    assert of.statistics
    width = COLUMNS["double" if len(of.statistics.results) > 1 else "single"]
    return (
        compared.boxes(of.statistics, width=width),
        caption.of_boxes(of.statistics),
        (),
    )


def _parameter(results: Results, figure: Figure, of: Compare) -> Made:
    assert of.statistics
    width = COLUMNS["double" if len(of.statistics.results) > 1 else "single"]
    drawn = compared.parameter(of.statistics, figure.field, width=width)
    return drawn, caption.of_parameter(of.statistics, figure.field), ()


def _profile(results: Results, figure: Figure, of: Compare) -> Made:
    first = of.aggregates[0]
    return (
        compared.profiles(first, width=120.0),
        caption.of_profiles(first, of.groups[0].runs[0]),
        (),
    )


def _creatures(results: Results, figure: Figure, of: Compare) -> Made:
    """Draw a stroke of the fittest creature of each group, from recorded poses."""
    fittest = [(group, _fittest(group.runs)) for group in of.groups]
    with_elites = [(group, run.name) for group, run in fittest if _best(run) > -np.inf]
    if not with_elites:
        raise ValueError("a run with an elite is needed, got none")
    shown, labels = [], []
    for numeral, (group, name) in zip(
        sheet.numerals(len(with_elites)), with_elites, strict=True
    ):
        tree, attributes = load(results.runs[name].data)
        fitness = tree["archive"]["fitness"]
        best = int(np.argmax(fitness))
        shown.append(strips.strip(float(fitness[best]), streams(tree, attributes)[best]))
        seed = results.runs[name].run.spec.seed
        labels.append(f"{numeral}: {group.name}, run {name}, seed {seed}")
    labels += [f"{group.name} has no elites" for group, run in fittest if _best(run) == -np.inf]
    text = (
        f"The fittest creature of each group ({'; '.join(labels)}). {MOMENTS} moments of one "
        "stroke, in order and from dark to light; the dot marks the first node. Bodies have "
        "one scale and travel upwards; the arrow is the way of one stroke, the number the "
        "fitness."
    )
    return strips.strips(shown, moments=MOMENTS), text, tuple(name for _, name in with_elites)


def _sheet(results: Results, figure: Figure, of: Compare) -> Made:
    """Draw the gaits of the fittest run of all."""
    from ..viz.figures import sheet

    runs = [run for group in of.groups for run in group.runs]
    name = _fittest(runs).name
    data = results.runs[name].data
    archive = read(data)
    plan = sheet.layout(archive)
    moved = sheet.motions(data, [int(archive.cells[one.elite]) for one in plan.regions])
    drawn = sheet.sheet(archive, plan, moved, width=COLUMNS["double"])
    return drawn, f"Run {name}. {caption.of_sheet(archive, plan, moved, 5)}", (name,)


def _fittest(runs: Sequence[RunRecord]) -> RunRecord:
    return max(runs, key=_best)


_best = Measure("best").of
"""The best fitness of a run; minus infinity without elites."""


_DRAW: dict[str, Callable[[Results, Figure, Compare], Made]] = {
    "curves": _curves,
    "box": _box,
    "parameter": _parameter,
    "profile": _profile,
    "creatures": _creatures,
    "sheet": _sheet,
}
