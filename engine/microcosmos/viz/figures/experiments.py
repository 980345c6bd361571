"""Figures of experiments without an archive: sweeps of gaits, scaling, folding."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from ...archive.atomic import write_whole
from ...archive.file import read_table
from ...sizes import size
from .style import (
    COLOURS,
    GREY,
    INCH,
    Row,
    blank,
    encoded,
    kind,
    legend_below,
    look,
    require_columns,
    tidy,
)

SCALING_COLUMNS = ("method", "nodes", "seconds")

PARTS = {
    "fluid": "fluid",
    "coupling": "interpolation and spreading",
    "constraints": "constraints",
    "steric": "steric repulsion",
}

OURS = {"color": "#1b2226", "marker": "o", "lw": 2.2}
PAIRS = {"color": COLOURS[4], "marker": "v", "ls": "--"}


def scaling(rows: Sequence[Row], summary: Row | None = None) -> Any:
    """Draw time of 1,000 steps, whole and by parts, and memory against the number of nodes.

    `summary` has the fitted powers; the dotted line is proportional to the nodes.
    """
    require_columns(rows, SCALING_COLUMNS)
    rows = sorted(rows, key=lambda row: row["nodes"])
    ours = [row for row in rows if row["method"] == "microcosmos"]
    pairs = [row for row in rows if row["method"] == "all-pairs"]
    figure = blank(INCH * 10.5, INCH * 4.8)
    time, memory = figure.subplots(1, 2, width_ratios=(3, 2))
    _proportional(time, ours)
    _measured(
        time, pairs, "seconds", "all pairs" + _power(summary, "exponent_all_pairs"), PAIRS
    )
    of_nodes = _power(summary, "exponent", "the nodes’ part ")
    _measured(time, ours, "seconds", "Microcosmos" + of_nodes, OURS)
    for number, (part, name) in enumerate(PARTS.items()):
        _measured(time, ours, part, name, look(number) | {"ms": 4, "lw": 1.1})
    _measured(memory, pairs, "memory_bytes", "all pairs", PAIRS)
    _measured(memory, ours, "memory_bytes", "Microcosmos", OURS)
    _log_log(time, "time of 1,000 steps [s]")
    _log_log(memory, "memory")
    legend_below(figure, time.get_legend_handles_labels(), 4)
    memory.yaxis.set_major_formatter(lambda count, _: size(count))
    return figure


def _measured(panel: Any, rows: Sequence[Row], name: str, label: str, style: dict) -> None:
    """Draw the positive values of a column: parts below the clock's resolution have no log."""
    known = [row for row in rows if (row.get(name) or 0) > 0]
    if known:
        nodes = [row["nodes"] for row in known]
        panel.plot(nodes, [row[name] for row in known], label=label, **style)


def _power(summary: Row | None, name: str, what: str = "") -> str:
    power = (summary or {}).get(name)
    return "" if power is None else f" ({what}∝ n$^{{{power:.2f}}}$)"


def _proportional(panel: Any, rows: Sequence[Row]) -> None:
    if len(rows) < 2:
        return
    first, last, top = rows[0]["nodes"], rows[-1]["nodes"], rows[-1]["seconds"]
    style = {"color": GREY, "ls": ":", "lw": 1.2, "label": "∝ n"}
    panel.plot([first, last], [top * first / last, top], **style)


def _log_log(panel: Any, what: str) -> None:
    panel.set(xscale="log", yscale="log", xlabel="nodes, n", ylabel=what)
    tidy(panel)


GAIT_COLUMNS = ("form", "swimmer", "viscosity", "displacement", "status")

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
    require_columns(rows, GAIT_COLUMNS)
    known = {row["form"] for row in rows}
    forms = [form for form in FORMS if form in known] + sorted(known - FORMS.keys())
    swimmers = list(dict.fromkeys(row["swimmer"] for row in rows))
    figure = blank(INCH * (3.4 * len(forms) + 1.2), INCH * 4.4)
    panels = figure.subplots(1, len(forms), squeeze=False)[0]
    for panel, form in zip(panels, forms, strict=True):
        of_form = [row for row in rows if row["form"] == form]
        for number, swimmer in enumerate(swimmers):
            own = [row for row in of_form if row["swimmer"] == swimmer]
            _swimmer(panel, sorted(own, key=lambda row: row["viscosity"]), swimmer, number)
        _dress_form(panel, form, of_form)
    panels[0].set_ylabel("displacement [cells a cycle]")
    for panel, form in zip(panels, forms, strict=True):
        # Forms that are force-free share a scale, which the other results would flatten.
        force_free = _all_force_free(rows, form)
        panel.set_ylim(0, _top([row for row in rows if _force_free(row) == force_free]))
    _legend(figure, panels[0], rows)
    return figure


def _swimmer(panel: Any, rows: Sequence[Row], swimmer: str, number: int) -> None:
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
    displacement = row["displacement"]
    return row["status"] == "ok" and displacement is not None and isfinite(displacement)


def _dress_form(panel: Any, form: str, rows: Sequence[Row]) -> None:
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
    # More numbers would overlap on the axis.
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


def figure_of(data: bytes) -> Any:
    """Return the figure of a run's file. Raises `ValueError` for other experiments."""
    table = read_table(data)
    if table.experiment == "gaits":
        return sweep(table.rows)
    if table.experiment == "scaling":
        from ...experiments.scaling import summary  # Loads JAX.

        return scaling(table.rows, summary(table.rows))
    if table.experiment == "folding":
        from .folding import folds  # Loads JAX.

        return folds(data)
    needed = "gaits, scaling or folding"
    raise ValueError(f"`experiment` must be {needed}, got {table.experiment!r}.")


def save(figure: Any, path: str | Path) -> None:
    """Write a figure as .pdf, .svg or .png."""
    write_whole(Path(path), encoded(figure, kind(Path(path)), dpi=160))
