"""Curves of runs: QD score, coverage and best fitness, with bands over seeds."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...archive.curves import CURVES, SHARES, curve_title
from ...statistics import Group
from ...statistics.measures import values_of
from .reading import Described, fitness_label, spread
from .style import COLOURS, blank, drawable, legend_above, lettered, plain

SHOWN = ("best", "coverage", "qd_score")

DASHES = ("-", (0, (4, 1.5)), (0, (1, 1)), (0, (4, 1, 1, 1)))
"""Dashes that tell lines apart in grey, or when colours repeat."""


def curves(
    groups: Sequence[Group],
    *,
    shown: Sequence[str] = SHOWN,
    against: str = "evaluations",
    width: float = 178.0,
) -> Any:
    """Draw a panel for each of `shown`, against `evaluations` or `generations`.

    Each group has the median over its seeds, a band between the quartiles, and thin lines for
    single runs.
    """
    _refuse_unknown(shown, groups)
    # A legend above the panels takes 7 mm.
    figure = blank(width, max(45.0, 0.72 * width / len(shown)) + 7 * (len(groups) > 1))
    panels = figure.subplots(1, len(shown), squeeze=False)[0]
    for panel, name in zip(panels, shown, strict=True):
        for number, group in enumerate(groups):
            _group(panel, group, name, against, number)
        _dress(panel, name, against, groups)
    lettered(panels)
    if len(groups) > 1:
        legend_above(figure, panels[0], len(groups))
    return figure


def _refuse_unknown(shown: Sequence[str], groups: Sequence[Group]) -> None:
    runs = [run for group in groups for run in group.runs]
    common = [name for name in runs[0].curves if all(name in run.curves for run in runs)]
    if not shown:
        raise ValueError(f"`shown` must be one or more of {', '.join(common)}, got none.")
    for name in shown:
        if name not in common:
            raise ValueError(f"`shown` must be of {', '.join(common)}, got {name!r}.")


def _group(panel: Any, group: Group, name: str, against: str, number: int) -> None:
    colour, dash = COLOURS[number % len(COLOURS)], DASHES[number % len(DASHES)]
    factor = 100 if name in SHARES else 1  # Per cent.
    values = [factor * values_of(run.curves, name) for run in group.runs]
    places = [_places(run.curves, against) for run in group.runs]
    if len(values) > 1:
        for x, y in zip(places, values, strict=True):
            known = ~np.isnan(y)
            _line(panel, x[known], y[known], color=colour, lw=0.4, alpha=0.55, label="_run")
    # Corrected curves have numbers where elites were evaluated again: lines lead through these.
    length = min(map(len, values))
    known = ~np.isnan([y[:length] for y in values]).any(axis=0)
    if not known.any():
        runs = f"all runs of {group.name!r}" if group.name else "all runs"
        raise ValueError(f"`shown` needs a generation with `{name}` of {runs}, got none.")
    low, middle, high = spread([y[:length][known] for y in values])
    along = np.median([x[:length][known] for x in places], axis=0)
    if len(values) > 1:
        panel.fill_between(along, low, high, color=colour, alpha=0.22, lw=0, label="_quartiles")
    seeds = f"n = {len(group.runs)}"
    label = f"{drawable(group.name)} ({seeds})" if group.name else seeds
    _line(panel, along, middle, color=colour, lw=1.2, ls=dash, label=label)


def _line(panel: Any, along: np.ndarray, values: np.ndarray, **look: Any) -> None:
    """Draw a line; a single point, which no line shows, as a dot."""
    panel.plot(along, values, marker="." if np.isfinite(values).sum() == 1 else "", **look)


def _places(columns: Mapping[str, np.ndarray], against: str) -> np.ndarray:
    if against not in ("evaluations", "generations"):
        raise ValueError(f"`against` must be evaluations or generations, got {against!r}.")
    evaluations = columns["evaluations"]
    return evaluations if against == "evaluations" else np.arange(1, len(evaluations) + 1)


def _dress(panel: Any, name: str, against: str, groups: Sequence[Group]) -> None:
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    along = "Generation" if against == "generations" else "Evaluations"
    panel.set(
        xlabel=along,
        ylabel=curve_label(name, [run for one in groups for run in one.runs]),
        xlim=(0, None),
    )
    panel.xaxis.set_major_locator(MaxNLocator(4, integer=True))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:,.0f}"))
    plain(panel)


def curve_label(name: str, runs: Sequence[Described]) -> str:
    """Return the title of a curve with the unit of fitness, if runs have one."""
    labels = {fitness_label(run) for run in runs}
    fitness = labels.pop() if len(labels) == 1 else "Fitness"
    title, _, unit = fitness.partition(" [")
    unit = f" [{unit}" if unit else ""
    if name in ("best", "mean"):
        return f"{name.capitalize()} {title[0].lower()}{title[1:]}{unit}"
    if name in SHARES:
        unit = " [%]"
    elif name not in CURVES or CURVES[name].of == "count":
        unit = ""
    shown = curve_title(name)
    return f"{shown[0].upper()}{shown[1:]}{unit}"
