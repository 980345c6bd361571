"""The figure of a sweep: displacement of swimmers at each viscosity, in each form."""

from collections.abc import Sequence
from math import isfinite
from typing import Any

from .style import GREY, INCH, Row, blank, legend_below, look, require_columns, tidy

NEEDED = ("form", "swimmer", "viscosity", "displacement", "status")

FORMS = {
    "ours": "Ours",
    "strong": "Ours, unlimited strength",
    "paper": "The paper’s literal form",
}

NOT_FORCE_FREE_COLOUR = "#f4eee0"
"""Background of results that are not force-free."""

MOST_TICKS = 5


def sweep(rows: Sequence[Row]) -> Any:
    """Draw displacement in a cycle against viscosity: a panel a form, a line a swimmer.

    A hollow mark means an active limit, a cross at the top an unfinished simulation.
    Forms that are not force-free are shaded; the upper axis has the worm's Reynolds number.
    """
    require_columns(rows, NEEDED)
    found = {row["form"] for row in rows}
    forms = [form for form in FORMS if form in found] + sorted(found - FORMS.keys())
    swimmers = list(dict.fromkeys(row["swimmer"] for row in rows))
    figure = blank(INCH * (3.4 * len(forms) + 1.2), INCH * 4.4)
    panels = figure.subplots(1, len(forms), squeeze=False)[0]
    for panel, form in zip(panels, forms, strict=True):
        here = [row for row in rows if row["form"] == form]
        for number, swimmer in enumerate(swimmers):
            own = [row for row in here if row["swimmer"] == swimmer]
            _line(panel, sorted(own, key=lambda row: row["viscosity"]), swimmer, number)
        _dress(panel, form, here)
    panels[0].set_ylabel("displacement [cells a cycle]")
    for panel, form in zip(panels, forms, strict=True):
        force_free = _all_force_free(rows, form)
        panel.set_ylim(0, _top([row for row in rows if _force_free(row) == force_free]))
    _legend(figure, panels[0], rows)
    return figure


def _line(panel: Any, rows: Sequence[Row], swimmer: str, number: int) -> None:
    style, mew = look(number), 1.4
    ends = [row["displacement"] if _finished(row) else float("nan") for row in rows]
    panel.plot([row["viscosity"] for row in rows], ends, label=swimmer, ms=5.5, **style)
    limited = [row for row in rows if _finished(row) and row.get("limited")]
    panel.plot(
        [row["viscosity"] for row in limited],
        [row["displacement"] for row in limited],
        **style | {"ls": "", "mfc": panel.get_facecolor(), "ms": 5.5, "mew": mew},
        label=f"_{swimmer}, limited",
    )
    failed = [row["viscosity"] for row in rows if not _finished(row)]
    panel.plot(
        failed,
        [0.96 - 0.04 * number] * len(failed),
        **style | {"ls": "", "marker": "x", "ms": 5.5, "mew": mew},
        label=f"_{swimmer}, unfinished",
        transform=panel.get_xaxis_transform(),
    )


def _force_free(row: Row) -> bool:
    return bool(row.get("force_free", True))


def _all_force_free(rows: Sequence[Row], form: str) -> bool:
    return all(_force_free(row) for row in rows if row["form"] == form)


def _top(rows: Sequence[Row]) -> float:
    most = max((row["displacement"] for row in rows if _finished(row)), default=0) or 1
    return most * (1.06 if all(map(_finished, rows)) else 1.25)


def _finished(row: Row) -> bool:
    found = row["displacement"]
    return row["status"] == "ok" and found is not None and isfinite(found)


def _dress(panel: Any, form: str, rows: Sequence[Row]) -> None:
    title = FORMS.get(form, form)
    if not _all_force_free(rows, form):
        panel.set_facecolor(NOT_FORCE_FREE_COLOUR)
        title += " (not force-free)"
    panel.set_title(title, fontsize=10.5)
    panel.set(xscale="log", xlabel="viscosity [cells²/step]")
    tidy(panel)
    _reynolds_axis(panel, rows)


def _reynolds_axis(panel: Any, rows: Sequence[Row]) -> None:
    known = [row for row in rows if _finished(row) and (row.get("reynolds") or 0) > 0]
    if not known:
        return
    swimmer = min((row["swimmer"] for row in known), key=lambda name: name != "worm")
    own = [row for row in known if row["swimmer"] == swimmer]
    own.sort(key=lambda row: row["viscosity"])
    own = own[:: -(-len(own) // MOST_TICKS)]
    upper = panel.secondary_xaxis("top")
    numbers = [float(f"{row['reynolds']:.2g}") for row in own]
    upper.set_xticks([row["viscosity"] for row in own], [f"{n:,.6g}" for n in numbers])
    upper.minorticks_off()
    upper.tick_params(colors=GREY, labelsize=8)
    upper.set_xlabel(f"Reynolds number of the {swimmer}", color=GREY, fontsize=8.5)


def _legend(figure: Any, panel: Any, rows: Sequence[Row]) -> None:
    from matplotlib.lines import Line2D

    handles, labels = panel.get_legend_handles_labels()
    mark = {"ls": "", "color": GREY, "mew": 1.4, "ms": 5.5}
    if any(_finished(row) and row.get("limited") for row in rows):
        handles.append(Line2D([], [], marker="o", mfc="white", **mark))
        labels.append("a limit was active")
    if not all(map(_finished, rows)):
        handles.append(Line2D([], [], marker="x", **mark))
        labels.append("did not finish")
    legend_below(figure, (handles, labels), len(labels))
