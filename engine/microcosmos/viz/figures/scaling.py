"""The figure of a scaling run: time and memory against the number of nodes."""

from collections.abc import Sequence
from typing import Any

from ...sizes import size
from .style import COLOURS, GREY, INCH, Row, blank, legend_below, look, require_columns, tidy

NEEDED = ("method", "nodes", "seconds")

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
    require_columns(rows, NEEDED)
    rows = sorted(rows, key=lambda row: row["nodes"])
    ours = [row for row in rows if row["method"] == "microcosmos"]
    pairs = [row for row in rows if row["method"] == "all-pairs"]
    figure = blank(INCH * 10.5, INCH * 4.8)
    time, memory = figure.subplots(1, 2, width_ratios=(3, 2))
    _proportional(time, ours)
    _line(time, pairs, "seconds", "all pairs" + _power(summary, "exponent_all_pairs"), PAIRS)
    of_nodes = _power(summary, "exponent", "the nodes’ part ")
    _line(time, ours, "seconds", "Microcosmos" + of_nodes, OURS)
    for number, (part, name) in enumerate(PARTS.items()):
        _line(time, ours, part, name, look(number) | {"ms": 4, "lw": 1.1})
    _line(memory, pairs, "memory_bytes", "all pairs", PAIRS)
    _line(memory, ours, "memory_bytes", "Microcosmos", OURS)
    _dress(time, "time of 1,000 steps [s]")
    _dress(memory, "memory")
    legend_below(figure, time.get_legend_handles_labels(), 4)
    memory.yaxis.set_major_formatter(lambda count, _: size(count))
    return figure


def _line(panel: Any, rows: Sequence[Row], name: str, label: str, style: dict) -> None:
    """Draw the positive values of a column: parts below the clock's resolution have no log."""
    known = [row for row in rows if (row.get(name) or 0) > 0]
    if known:
        nodes = [row["nodes"] for row in known]
        panel.plot(nodes, [row[name] for row in known], label=label, **style)


def _power(summary: Row | None, name: str, what: str = "") -> str:
    found = (summary or {}).get(name)
    return "" if found is None else f" ({what}∝ n$^{{{found:.2f}}}$)"


def _proportional(panel: Any, rows: Sequence[Row]) -> None:
    if len(rows) < 2:
        return
    first, last, top = rows[0]["nodes"], rows[-1]["nodes"], rows[-1]["seconds"]
    style = {"color": GREY, "ls": ":", "lw": 1.2, "label": "∝ n"}
    panel.plot([first, last], [top * first / last, top], **style)


def _dress(panel: Any, what: str) -> None:
    panel.set(xscale="log", yscale="log", xlabel="nodes, n", ylabel=what)
    tidy(panel)
