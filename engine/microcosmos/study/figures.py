"""The figures of a study, with captions that name groups, runs and tests."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..archive.atomic import write_whole
from ..archive.file import load
from ..archive.poses import streams
from ..statistics import RunRecord
from ..statistics.measures import Measure
from ..viz.figures import caption, compared, compared_caption, curves, saving, sheet, strips
from ..viz.figures.groups import Group as Drawn
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
    """It fills the width of a page."""


def draw(results: Results, tell: Callable[[int], None] = lambda done: None) -> list[Picture]:
    """Draw the figures of a study. Raises `ValueError` where one cannot be drawn."""
    found = []
    for number, figure in enumerate(results.plan.study.figures):
        name, _ = results.plan.study.comparison_of(figure)
        try:
            found.append(_picture(results, figure, results.comparisons[name]))
        except ValueError as error:
            raise ValueError(f"figures.{number} ({figure.kind}): {error}") from error
        tell(number + 1)
    return found


def save(pictures: list[Picture], folder: Path) -> list[Path]:
    """Write every figure as SVG and PDF, with its caption; return the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for number, one in enumerate(pictures, 1):
        path = folder / f"{number}-{one.kind}.svg"
        files = {".svg": one.svg, ".pdf": one.pdf, ".caption.txt": f"{one.caption}\n".encode()}
        for suffix, data in files.items():
            write_whole(path.with_suffix(suffix), data)
            written.append(path.with_suffix(suffix))
    return written


def _picture(results: Results, figure: Figure, of: Compare) -> Picture:
    ids = tuple(run.name for group in of.groups for run in group.runs)
    with styled():
        drawn, text, shown = _DRAW[figure.kind](results, figure, of)
        svg, pdf = (saving.encoded(drawn, suffix, caption=text) for suffix in FORMATS)
    wide = drawn.get_figwidth() * INCH > PART_OF_PAGE
    return Picture(figure.kind, of.name, svg, pdf, text, shown or ids, wide)


Made = tuple[Any, str, tuple[str, ...]]
"""A figure, its caption, and the runs that it shows; none: all of the comparison."""


def _curves(results: Results, figure: Figure, of: Compare) -> Made:
    groups = [Drawn(group.name, group.runs) for group in of.groups]
    drawn = curves.curves(groups, shown=figure.shown)
    return drawn, caption.of_curves(groups, figure.shown), ()


def _box(results: Results, figure: Figure, of: Compare) -> Made:
    assert of.statistics
    width = COLUMNS["double" if len(of.statistics.results) > 1 else "single"]
    return (
        compared.boxes(of.statistics, width=width),
        compared_caption.of_boxes(of.statistics),
        (),
    )


def _parameter(results: Results, figure: Figure, of: Compare) -> Made:
    assert of.statistics
    width = COLUMNS["double" if len(of.statistics.results) > 1 else "single"]
    drawn = compared.parameter(of.statistics, figure.field, width=width)
    return drawn, compared_caption.of_parameter(of.statistics, figure.field), ()


def _profile(results: Results, figure: Figure, of: Compare) -> Made:
    first = of.aggregates[0]
    return (
        compared.profiles(first, width=120.0),
        compared_caption.of_profiles(first, of.groups[0].runs[0]),
        (),
    )


def _creatures(results: Results, figure: Figure, of: Compare) -> Made:
    """Draw a stroke of the fittest creature of each group, from recorded poses."""
    fittest = [(group, _fittest(group.runs)) for group in of.groups]
    found = [(group, run.name) for group, run in fittest if _best(run) > -np.inf]
    if not found:
        raise ValueError("a run with an elite is needed, got none")
    shown, said = [], []
    for numeral, (group, name) in zip(sheet.numerals(len(found)), found, strict=True):
        tree, attributes = load(results.runs[name].data)
        fitness = tree["archive"]["fitness"]
        best = int(np.argmax(fitness))
        shown.append(strips.strip(float(fitness[best]), streams(tree, attributes)[best]))
        seed = results.runs[name].run.spec.seed
        said.append(f"{numeral}: {group.name}, run {name}, seed {seed}")
    said += [f"{group.name} has no elites" for group, run in fittest if _best(run) == -np.inf]
    text = (
        f"The fittest creature of each group ({'; '.join(said)}). {MOMENTS} moments of one "
        "stroke, in order and from dark to light; the dot marks the first node. Bodies have "
        "one scale and travel upwards; the arrow is the way of one stroke, the number the "
        "fitness."
    )
    return strips.strips(shown, moments=MOMENTS), text, tuple(name for _, name in found)


def _sheet(results: Results, figure: Figure, of: Compare) -> Made:
    """Draw the gaits of the fittest run of all."""
    from ..viz.figures import motions  # Loads JAX.

    runs = [run for group in of.groups for run in group.runs]
    name = _fittest(runs).name
    data = results.runs[name].data
    found = read(data)
    plan = sheet.layout(found)
    moved = motions.motions(data, [int(found.cells[one.elite]) for one in plan.regions])
    drawn = sheet.sheet(found, plan, moved, width=COLUMNS["double"])
    return drawn, f"Run {name}. {caption.of_sheet(found, plan, moved, 5)}", (name,)


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
