"""Numbers, durations and states of runs as text."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from ..archive.curves import CORRECTED, SHARES, curve_title

MEASURES = {name: curve_title(name) for name in ("qd_score", "coverage")} | {"best": "best"}
"""Titles of the measures of an archive's quality, for lines of a terminal."""
UNITS = ((86400, "d", 3600, "h"), (3600, "h", 60, "min"), (60, "min", 1, "s"))
COLOURS = {
    "finished": "green",
    "failed": "red",
    "running": "cyan",
    "cancelled": "yellow",
    "paused": "yellow",
}
HIDDEN = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)
"""Characters that steer a terminal, turn the direction of text, or cannot be written."""


def visible(text: str) -> str:
    """Return a text with hidden characters as escapes, which are those of JSON.

    Other people write names and reasons: nothing in them may act on a reader's terminal.
    """
    return HIDDEN.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def visible_lines(text: str) -> str:
    """Return a text of several lines with other hidden characters as escapes."""
    return "\n".join(map(visible, text.split("\n")))


def duration(seconds: float | None) -> str:
    """Format a duration in its two largest units."""
    if seconds is None:
        return ""
    whole = max(0, round(seconds))
    for large, name, small, rest in UNITS:
        if whole >= large:
            return f"{whole // large} {name} {whole % large // small} {rest}"
    return f"{whole} s"


def figure(name: str, value: float | None) -> str:
    if value is None:
        return "–"
    return f"{100 * value:.1f} %" if name in SHARES else f"{value:.4g}"


def corrected_titles(records: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Return the titles of measures after reevaluation, if any of the records has them."""
    known = any(record.get(name) is not None for record in records for name in CORRECTED)
    return {name: curve_title(name) for name in CORRECTED} if known else {}


def figures(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the quality of a run's archive, or the summary of its table."""
    if record.get("qd_score") is not None:
        titles = MEASURES | corrected_titles([record])
        return [(title, figure(name, record[name])) for name, title in titles.items()]
    summary = record.get("summary") or {}
    numbers = ((name, value) for name, value in summary.items() if type(value) in (int, float))
    shown = list(numbers)[:4]
    return [(visible(name).replace("_", " "), f"{value:.4g}") for name, value in shown]


def title(record: Mapping[str, Any]) -> str:
    """Return experiment, name and short id."""
    return visible(f"{record['experiment']}{quoted(record)}  {record['id'][:8]}")


def quoted(record: Mapping[str, Any]) -> str:
    return visible(f" “{record['name']}”") if record.get("name") else ""


def status_of(record: Mapping[str, Any]) -> str:
    """Return the status, and the requested one."""
    requested = record.get("requested_state")
    return visible(record["status"] + (f", to be {requested}" if requested else ""))


def status_and_reason(record: Mapping[str, Any]) -> str:
    reason = record.get("waiting_reason") or record.get("error")
    return status_of(record) + (visible(f": {reason}") if reason else "")


def counts_as_text(counts: Mapping[str, int]) -> str:
    """Format the number of runs by status."""
    return visible(", ".join(f"{count} {status}" for status, count in counts.items() if count))


def done(record: Mapping[str, Any]) -> str:
    unit = record.get("unit", "generations")
    return f"{record['generation']}/{record['generations']} {unit}"


def speed(record: Mapping[str, Any]) -> str:
    """Format the rate of a run and its remaining time."""
    rate, remaining = record.get("evaluations_per_second"), record.get("eta_seconds")
    parts = [f"{rate:.3g} evaluations/s"] if rate and record["status"] == "running" else []
    parts += [f"{duration(remaining)} left"] if remaining is not None else []
    return "   ".join(parts)
