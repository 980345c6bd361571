"""Curves of runs: QD score, coverage and best fitness, with bands over seeds."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...statistics.measures import values_of
from .axes import fitness_label
from .groups import Group, spread
from .reading import Described
from .style import COLOURS, GREY, blank, lettered

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
    figure = blank(width, max(45.0, 0.72 * width / len(shown)) + 7 * (len(groups) > 1))
    panels = figure.subplots(1, len(shown), squeeze=False)[0]
    for panel, name in zip(panels, shown, strict=True):
        for number, group in enumerate(groups):
            _group(panel, group, name, against, number)
        _dress(panel, name, against, groups)
    lettered(panels)
    if len(groups) > 1:
        handles, labels = panels[0].get_legend_handles_labels()
        place = "outside upper center"
        figure.legend(handles, labels, loc=place, ncols=min(3, len(groups)), frameon=False)
    return figure


def _refuse_unknown(shown: Sequence[str], groups: Sequence[Group]) -> None:
    runs = [run for group in groups for run in group.runs]
    there = [name for name in runs[0].curves if all(name in run.curves for run in runs)]
    if not shown:
        raise ValueError(f"`shown` must be one or more of {', '.join(there)}, got none.")
    for name in shown:
        if name not in there:
            raise ValueError(f"`shown` must be of {', '.join(there)}, got {name!r}.")


def _group(panel: Any, group: Group, name: str, against: str, number: int) -> None:
    colour, dash = COLOURS[number % len(COLOURS)], DASHES[number % len(DASHES)]
    factor = 100 if name in ("coverage", "corrected_coverage", "hit_rate") else 1  # Per cent.
    values = [factor * values_of(run.curves, name) for run in group.runs]
    places = [_places(run.curves, against) for run in group.runs]
    if len(values) > 1:
        for x, y in zip(places, values, strict=True):
            panel.plot(x, y, color=colour, lw=0.4, alpha=0.55, label="_run")
    low, middle, high = spread(values)
    along = np.median(np.stack([x[: len(middle)] for x in places]), axis=0)
    if len(values) > 1:
        panel.fill_between(along, low, high, color=colour, alpha=0.22, lw=0, label="_quartiles")
    seeds = f"n = {len(group.runs)}"
    label = f"{group.label} ({seeds})" if group.label else seeds
    panel.plot(along, middle, color=colour, lw=1.2, ls=dash, label=label)


def _places(columns: dict[str, np.ndarray], against: str) -> np.ndarray:
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
    panel.set_axisbelow(True)
    panel.grid(color=GREY, alpha=0.18, lw=0.4)
    panel.spines[["top", "right"]].set_visible(False)


def curve_label(name: str, runs: Sequence[Described]) -> str:
    """Return the title of a curve with the unit of fitness, if runs have one."""
    labels = {fitness_label(run) for run in runs}
    fitness = labels.pop() if len(labels) == 1 else "Fitness"
    title, _, unit = fitness.partition(" [")
    unit = f" [{unit}" if unit else ""
    return {
        "best": f"Best {title[0].lower()}{title[1:]}{unit}",
        "mean": f"Mean {title[0].lower()}{title[1:]}{unit}",
        "coverage": "Coverage [%]",
        "qd_score": f"QD score{unit}",
        "corrected_qd_score": f"Corrected QD score{unit}",
        "corrected_coverage": "Corrected coverage [%]",
        "hit_rate": "Repeats in their own cell [%]",
    }.get(name, name.replace("_", " ").capitalize())
