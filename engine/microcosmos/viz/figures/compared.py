"""Groups of runs beside each other: boxes with all points, performance against a parameter,
performance profiles."""

from collections.abc import Sequence
from textwrap import wrap
from typing import Any

import numpy as np

from ...archive.curves import SHARES
from ...spec.paths import key, number_text, short, value_texts
from ...statistics import Aggregates, Comparison
from ...statistics.comparison import Result, Summary
from ...statistics.effects import quartiles
from ...statistics.groups import distinct
from .curves import DASHES, curve_label
from .style import (
    COLOURS,
    INK,
    blank,
    drawable,
    legend_above,
    legend_of_groups,
    lettered,
    look,
    plain,
)

GOLDEN = (5**0.5 - 1) / 2
"""Golden ratio: its multiples modulo 1 stay apart, whatever their number."""
SPREAD = 0.44
"""Width over which the points of a group lie, of the distance between groups."""
LETTER = 1.5
"""Width of a letter of a tick, with the room beside it, in mm."""
TALLEST = 62.0
"""Greatest height of a panel, in mm."""
COLUMNS = 3
"""Panels beside each other."""
DECADE = 8
"""A parameter whose values span this factor has a logarithmic axis."""


def boxes(comparison: Comparison, *, width: float = 178.0) -> Any:
    """Draw a panel for each measure: every run as a point, the box between the quartiles of
    each group, and its median as a line. Runs that do not reach a value stand at the top, and
    archives without elites at the bottom."""
    figure, panels = _panels(len(comparison.results), width)
    names, common = _ticks([drawable(group.name) for group in comparison.groups])
    room = max(8, int(width / min(COLUMNS, len(panels)) / len(names) / LETTER))
    for panel, result in zip(panels, comparison.results, strict=True):
        for number, one in enumerate(result.summaries):
            _box(panel, number, one, _factor(result))
            places = number + _apart(one.count)
            _mark_missing(panel, places, one, COLOURS[number % len(COLOURS)])
        ticks = ["\n".join(wrap(name, room)) for name in names]
        panel.set_xticks(range(len(names)), ticks, parse_math=False)
        panel.set(
            xlim=(-0.6, len(names) - 0.4), ylabel=_title(comparison, result), xlabel=common
        )
        plain(panel, "y")
    lettered(panels)
    return figure


def _ticks(names: Sequence[str]) -> tuple[list[str], str]:
    """Return the names of groups without the words with which all begin, and those words."""
    words = [name.split(" ") for name in names]
    common = 0
    while len(names) > 1 and len({tuple(one[: common + 1]) for one in words}) == 1:
        common += 1
    if not common or any(len(one) <= common for one in words):
        return list(names), ""
    first = " ".join(words[0][:common])
    return [" ".join(one[common:]) for one in words], first[0].upper() + first[1:]


def _panels(count: int, width: float, above: float = 0.0) -> tuple[Any, list[Any]]:
    """Return a figure with so many panels, and `above` mm for a legend."""
    columns = 2 if count == 4 else min(count, COLUMNS)
    rows = -(-count // columns)
    figure = blank(width, rows * min(max(48.0, 0.66 * width / columns), TALLEST) + above)
    panels = figure.subplots(rows, columns, squeeze=False).ravel().tolist()
    for panel in panels[count:]:
        panel.set_axis_off()
    return figure, panels[:count]


def _box(panel: Any, number: int, one: Summary, factor: float) -> None:
    from matplotlib.patches import Rectangle

    colour = COLOURS[number % len(COLOURS)]
    low, middle, high = (factor * x for x in (one.low, one.median, one.high))
    if np.isfinite(low) and np.isfinite(high):
        box = Rectangle((number - 0.3, low), 0.6, high - low)
        box.set(facecolor=colour, alpha=0.22, edgecolor="none")
        panel.add_patch(box)
    if np.isfinite(middle):
        panel.plot([number - 0.3, number + 0.3], [middle] * 2, color=colour, lw=1.6)
    values = factor * np.array(one.values)
    shown = values[np.isfinite(values)]
    places = number + _apart(len(values))[np.isfinite(values)]
    panel.plot(places, shown, "o", color=colour, ms=2.6, mec="white", mew=0.3)


def _apart(count: int) -> np.ndarray:
    """Return places of points around 0, the same each time."""
    return SPREAD * ((GOLDEN * np.arange(1, count + 1)) % 1 - 0.5)


def _mark_missing(panel: Any, places: np.ndarray, one: Summary, colour: Any) -> None:
    """Draw runs that do not reach the value as triangles at the top, and archives without
    elites as triangles at the bottom."""
    look = {"color": colour, "ms": 3.2, "mew": 0, "clip_on": False}
    for value, height, marker in ((np.inf, 1.0, "^"), (-np.inf, 0.0, "v")):
        missing = places[np.array(one.values) == value]
        if len(missing):  # An empty line without clipping has no extent.
            heights, trans = np.full(len(missing), height), panel.get_xaxis_transform()
            panel.plot(missing, heights, marker, transform=trans, **look)


def _factor(result: Result) -> float:
    measure = result.measure
    return 100.0 if measure.curve in SHARES and measure.reaches is None else 1.0


def _title(comparison: Comparison, result: Result) -> str:
    measure = result.measure
    runs = [run for group in comparison.groups for run in group.runs]
    if measure.reaches is not None:
        title = curve_label(measure.curve, runs).partition(" [")[0]
        return f"Evaluations to {title[0].lower()}{title[1:]} {number_text(measure.reaches)}"
    title = curve_label(measure.curve, runs)
    return title if measure.at is None else f"{title}, {measure.at:,} evaluations"


def parameter(comparison: Comparison, path: str, *, width: float = 178.0) -> Any:
    """Draw each measure against a field of the spec: every run, the median, and a band between
    the quartiles; a line for each combination of the other fields in which groups differ.

    Raises `ValueError` for a field that is no number, or does not differ.
    """
    lines = series(comparison, path)
    named = len(lines) > 1
    figure, panels = _panels(len(comparison.results), width, 7.0 * named)
    for panel, result in zip(panels, comparison.results, strict=True):
        for number, (name, members) in enumerate(lines.items()):
            _line(panel, members, result, number, name)
        _along(panel, path, [x for members in lines.values() for x, _ in members])
        panel.set(ylabel=_title(comparison, result))
        plain(panel, "y")
    lettered(panels)
    if named:
        legend_above(figure, panels[0], len(lines))
    return figure


Members = list[tuple[float, int]]
"""The field's value of each group, and the group's number."""


def series(comparison: Comparison, path: str) -> dict[str, Members]:
    """Return the groups along a field, by the other fields in which they differ."""
    if path not in comparison.differences:
        known = ", ".join(comparison.differences) or "none"
        raise ValueError(
            f"a parameter must differ between groups (it may be {known}), got {path}"
        )
    others = {one: own for one, own in comparison.differences.items() if one != path}
    # Labels are cut, so that two lines may have one.
    lines: dict[tuple[str, ...], Members] = {}
    for number, value in enumerate(comparison.differences[path]):
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"a parameter must be a number in every group, got {value!r}")
        line = tuple(key(own[number]) for own in others.values())
        lines.setdefault(line, []).append((float(value), number))
    texts = {one: value_texts(own) for one, own in others.items()}
    names = [
        ", ".join(f"{short(one)} {own[members[0][1]]}" for one, own in texts.items())
        for members in lines.values()
    ]
    return dict(zip(distinct(names), map(sorted, lines.values()), strict=True))


def _line(panel: Any, members: Members, result: Result, number: int, name: str) -> None:
    factor = _factor(result)
    summaries = [result.summaries[group] for _, group in members]
    places = np.array([x for x, _ in members])
    low, middle, high = (
        np.array([factor * x for x in side])
        for side in zip(*(quartiles(np.array(one.values)) for one in summaries), strict=True)
    )
    mark, dash = look(number), DASHES[number % len(DASHES)]
    panel.fill_between(places, low, high, color=mark["color"], alpha=0.22, lw=0)
    panel.plot(places, middle, **mark, ls=dash, lw=1.2, ms=3.5, label=drawable(name))
    for place, one in zip(places, summaries, strict=True):
        values = factor * np.array(one.values)
        panel.plot([place] * len(values), values, ".", color=mark["color"], ms=2.5, alpha=0.7)
        _mark_missing(panel, np.full(len(values), place), one, mark["color"])


def _along(panel: Any, path: str, places: Sequence[float]) -> None:
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

    shown = sorted(set(places))
    if shown[0] > 0 and shown[-1] >= DECADE * shown[0]:
        panel.set_xscale("log")
    panel.xaxis.set_minor_locator(NullLocator())
    panel.xaxis.set_minor_formatter(NullFormatter())
    if len(shown) <= 8:
        panel.xaxis.set_major_locator(FixedLocator(shown))
        panel.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    name = short(path)
    panel.set_xlabel(name[0].upper() + name[1:])


def profiles(aggregates: Aggregates, *, width: float = 85.0) -> Any:
    """Draw performance profiles: the share of runs above a score, with 95 % bands.

    Agarwal et al. 2021, arXiv:2108.13264; scores are relative to the first group's median.
    """
    figure = blank(width, 0.75 * width)
    panel = figure.add_subplot()
    for number, one in enumerate(aggregates.groups):
        colour = COLOURS[number % len(COLOURS)]
        if one.band:
            panel.fill_between(aggregates.scores, *one.band, color=colour, alpha=0.22, lw=0)
        dash = DASHES[number % len(DASHES)]
        line = {"color": colour, "lw": 1.2, "ls": dash, "label": drawable(one.group)}
        panel.plot(aggregates.scores, one.profile, **line)
    panel.axhline(0.5, color=INK, lw=0.5, ls=(0, (1, 2)))
    first = aggregates.groups[0].group
    title = aggregates.measure.title
    panel.set(
        xlabel=f"{title[0].upper()}{title[1:]}, relative to {first}", ylabel="Share of runs"
    )
    panel.set(ylim=(0, 1.02), xlim=(0, aggregates.scores[-1]))
    legend_of_groups(panel)
    plain(panel, "y")
    return figure
