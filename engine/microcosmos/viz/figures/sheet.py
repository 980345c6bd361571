"""The contact sheet of an archive: the fittest swimmer of each region, simulated anew."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...json_text import read_json
from ..replay_file import read_replay
from .maps import fittest
from .reading import Archive, Axis, chosen, fitness_label, read
from .style import GREY, INK, PALE, blank, colour_bar, shades

WORDS = {True: "trusted", False: "not trusted"}


def verdicts(reports: Sequence[Path]) -> dict[str, bool]:
    """Return the verdict on each audited creature, by its hash.

    Raises `ValueError` for a file that is not the report of an audit.
    """
    trusted = {}
    for path in reports:
        try:
            report = read_json(path.read_bytes())
            trusted[report["creature"]] = bool(report["verdict"]["trusted"])
        except (KeyError, TypeError, ValueError) as error:
            needed = "a report of `microcosmos audit FILE --out REPORT`"
            raise ValueError(f"`--audit` needs {needed}, got {path}: {error}") from error
    return trusted


@dataclass(frozen=True)
class Region:
    """The elite shown at (column, row), counted from the low ends."""

    column: int
    row: int
    elite: int


@dataclass(frozen=True)
class Layout:
    """The occupied regions of a sheet, and its part of each axis."""

    axes: tuple[Axis, Axis]
    ends: np.ndarray
    """Ends (axis, 2) of the sheet, as places from 0 to 1."""
    columns: int
    rows: int
    regions: tuple[Region, ...]


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of one body."""

    positions: np.ndarray
    """(frame, node, 2), unwrapped, in cells."""
    edges: np.ndarray
    """(edge, 2) node numbers."""
    trusted: bool | None = None
    """The verdict of the creature's audit, if it is known."""


def layout(
    archive: Archive, *, axes: list[str] | None = None, columns: int = 6, rows: int = 4
) -> Layout:
    """Divide the occupied part of two axes into equal regions, each with its fittest elite.

    Raises `ValueError` for a single axis.
    """
    along = chosen(archive, axes)
    if len(along) != 2:
        raise ValueError(
            "`axes` must be two for a sheet, such as --axes bending_effort,path_length"
        )
    for name, value in (("columns", columns), ("rows", rows)):
        if not 1 <= value <= 20:
            raise ValueError(f"`{name}` must be from 1 to 20, got {value}.")
    places = np.stack([axis.places(archive.measures[axis.name]) for axis in along])
    # The sheet ends at whole bins, so that regions of a grid are made of cells.
    bins = np.array([axis.bins for axis in along])
    low = np.floor(places.min(1) * bins + 1e-9)
    high = np.maximum(np.ceil(places.max(1) * bins - 1e-9), low + 1)
    ends = np.stack([low, high], 1) / bins[:, None]
    share = (places - ends[:, :1]) / np.diff(ends)
    counts = np.array([[columns], [rows]])
    region_of = np.clip((share * counts).astype(int), 0, counts - 1)
    regions = tuple(
        Region(*map(int, (*region_of[:, i], i))) for i in fittest(archive, region_of)
    )
    return Layout((along[0], along[1]), ends, columns, rows, regions)


def numerals(count: int) -> list[str]:
    """Return i, ii, iii, iv …, the paper's numerals for gaits."""
    digits = (("c", 100), ("xc", 90), ("l", 50), ("xl", 40), ("x", 10), ("ix", 9), ("v", 5),
              ("iv", 4), ("i", 1))  # fmt: skip
    names = []
    for number in range(1, count + 1):
        text = ""
        for letters, value in digits:
            text, number = text + letters * (number // value), number % value
        names.append(text)
    return names


def reading_order(regions: Sequence[Region]) -> list[int]:
    """Return indices of regions row by row from the top."""
    return sorted(range(len(regions)), key=lambda k: (-regions[k].row, regions[k].column))


FILLED = 0.8
"""Share of a region's side that the largest motion fills."""

BAR = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Lengths of the scale bar, in cells."""


def sheet(
    archive: Archive,
    plan: Layout,
    motions: Sequence[Motion],
    *,
    moments: int = 5,
    colours: str = "viridis",
    width: float = 178.0,
) -> Any:
    """Draw each region's swimmer at some moments, and the path of its middle.

    All have one scale; colours run from pale at the start to that of fitness at the end.
    """
    if not 1 <= moments <= 50:
        raise ValueError(f"`moments` must be from 1 to 50, got {moments}.")
    side = 0.86 * width / plan.columns
    figure = blank(width, side * plan.rows + 14)
    panel = figure.add_subplot()
    panel.set(xlim=(0, plan.columns), ylim=(0, plan.rows), aspect="equal")
    fitness = archive.fitness[[region.elite for region in plan.regions]]
    colouring = shades(fitness, colours)
    extents = [np.ptp(_shown(one, moments).reshape(-1, 2), axis=0).max() for one in motions]
    scale = FILLED / (float(max(extents)) or 1.0)
    digits = max(0, 2 - int(np.floor(np.log10(max(np.abs(fitness).max(), 1e-9)))))
    names = dict(zip(reading_order(plan.regions), numerals(len(motions)), strict=True))
    for number, (region, motion) in enumerate(zip(plan.regions, motions, strict=True)):
        corner = np.array([region.column, region.row])
        _body(panel, motion, corner + 0.5, scale, moments, colouring.to_rgba(fitness[number]))
        _named(panel, corner, names[number], f"{fitness[number]:.{digits}f}")
        if motion.trusted is not None:
            right, top = corner + 0.96
            look = {"fontsize": 4.5, "ha": "right", "va": "top", "color": GREY}
            panel.text(right, top, WORDS[motion.trusted], **look)
    _dress(panel, plan)
    _bar(panel, plan, scale, side)
    colour_bar(panel, colouring, fitness_label(archive), pad=0.01, aspect=32)
    return figure


def _shown(motion: Motion, moments: int) -> np.ndarray:
    """Return (moment, node, 2): the last frame, and others evenly before it."""
    last = len(motion.positions) - 1
    frames = np.rint(np.linspace(0, last, moments)).astype(int) if moments > 1 else [last]
    return motion.positions[frames].astype(float)


def _body(
    panel: Any, motion: Motion, middle: np.ndarray, scale: float, moments: int, colour: Any
) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgb

    shown = _shown(motion, moments)
    flat = shown.reshape(-1, 2)
    centre = (flat.min(0) + flat.max(0)) / 2
    for number, places in enumerate(shown):
        last = number == len(shown) - 1
        share = number / max(1, len(shown) - 1)
        pale = np.array(to_rgb(PALE)) * (1 - 0.45 * share)
        lines = (places[motion.edges] - centre) * scale + middle
        strokes = [(pale, 0.7, 2)]
        if last:  # With a dark border, so that light colours show on paper.
            strokes = [(INK, 1.9, 3), (colour, 1.2, 3)]
        for paint, width, order in strokes:
            look = {"colors": [paint], "linewidths": width, "zorder": order}
            panel.add_collection(LineCollection(list(lines), capstyle="round", **look))
    way = (motion.positions.mean(1) - centre) * scale + middle
    panel.plot(*way.T, color=INK, lw=0.5, zorder=4)
    panel.plot(*way[0], "o", color=INK, ms=1.2, mew=0, zorder=4)


def _named(panel: Any, corner: np.ndarray, name: str, fitness: str) -> None:
    left, bottom = corner + 0.04
    panel.text(left, bottom + 0.92, name, fontsize=5.5, va="top", color=INK)
    panel.text(left + 0.92, bottom, fitness, fontsize=5, ha="right", va="bottom", color=GREY)


def _dress(panel: Any, plan: Layout) -> None:
    for at in range(1, plan.columns):
        panel.axvline(at, color=PALE, lw=0.4, zorder=1)
    for at in range(1, plan.rows):
        panel.axhline(at, color=PALE, lw=0.4, zorder=1)
    counts = (plan.columns, plan.rows)
    for axis, ends, count, which in zip(plan.axes, plan.ends, counts, "xy", strict=True):
        values, texts = _ticks(axis, ends)
        share = (axis.places(values) - ends[0]) / (ends[1] - ends[0])
        getattr(panel, f"set_{which}ticks")(share * count, texts)
        getattr(panel, f"set_{which}label")(axis.label, parse_math=False)


def _ticks(axis: Axis, ends: np.ndarray) -> tuple[np.ndarray, list[str]]:
    from matplotlib.ticker import MaxNLocator

    low, high = axis.values(ends)
    if axis.logarithmic:
        decades = np.arange(np.ceil(np.log10(low) - 1e-6), np.floor(np.log10(high) + 1e-6) + 1)
        if len(decades) > 1:
            return 10.0**decades, [f"$10^{{{int(k)}}}$" for k in decades]
    values = MaxNLocator(5, steps=[1, 2, 5, 10]).tick_values(low, high)
    values = values[(values >= low - 1e-12) & (values <= high + 1e-12)]
    return values, [f"{value:.4g}" for value in values]


def _bar(panel: Any, plan: Layout, scale: float, side: float) -> None:
    length = max((cells for cells in BAR if cells * scale <= 0.6), default=BAR[0])
    y, end = plan.rows + 2.2 / side, plan.columns
    start = end - length * scale
    panel.plot([start, end], [y, y], color=INK, lw=1.2, clip_on=False, solid_capstyle="butt")
    text = f"{length} cell" + "s" * (length > 1)
    panel.text(start - 0.05, y, text, ha="right", va="center", fontsize=6)


def motions(
    data: bytes,
    cells: Sequence[int],
    trusted: Mapping[str, bool] | None = None,
    tell: Callable[[int], None] = lambda done: None,
) -> list[Motion]:
    """Simulate the elites in some cells; `tell` is called with the number done.

    `trusted` holds the verdicts of audits by creature.
    """
    # They load JAX, which the other figures do without (test_a_map_is_drawn_without_jax).
    from ...build import build
    from ...experiments.evolution import Evolution
    from ..replay import record

    experiment, found = build(read(data).spec), []
    assert isinstance(experiment, Evolution)
    state = experiment.restore(data, other_device=True)
    for cell in cells:
        replay = read_replay(record(experiment.creature(state, int(cell))))
        verdict = (trusted or {}).get(replay.header["creature"])
        found.append(Motion(replay.positions, replay.edges, verdict))
        tell(len(found))
    return found
