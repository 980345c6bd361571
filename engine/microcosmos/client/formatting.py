"""Numbers, durations and states of runs as text."""

from collections.abc import Mapping, Sequence
from typing import Any

MEASURES = {"qd_score": "QD score", "coverage": "coverage", "best": "best"}
"""Titles of the measures of an archive's quality."""
CORRECTED = {
    "corrected_qd_score": "corrected QD score",
    "corrected_coverage": "corrected coverage",
    "hit_rate": "hit rate",
}
"""Titles of those after reevaluation, which not every run has."""
SHARES = ("coverage", "corrected_coverage", "hit_rate")
UNITS = ((86400, "d", 3600, "h"), (3600, "h", 60, "min"), (60, "min", 1, "s"))
COLOURS = {
    "finished": "green",
    "failed": "red",
    "running": "cyan",
    "cancelled": "yellow",
    "paused": "yellow",
}


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
    return CORRECTED if known else {}


def figures(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the quality of a run's archive, or the summary of its table."""
    if record.get("qd_score") is not None:
        titles = MEASURES | corrected_titles([record])
        return [(title, figure(name, record[name])) for name, title in titles.items()]
    summary = record.get("summary") or {}
    numbers = ((name, value) for name, value in summary.items() if type(value) in (int, float))
    return [(name.replace("_", " "), f"{value:.4g}") for name, value in list(numbers)[:4]]


def title(record: Mapping[str, Any]) -> str:
    """Return experiment, name and short id."""
    return f"{record['experiment']}{quoted(record)}  {record['id'][:8]}"


def quoted(record: Mapping[str, Any]) -> str:
    return f" “{record['name']}”" if record.get("name") else ""


def status_of(record: Mapping[str, Any]) -> str:
    """Return the status, and the requested one."""
    requested = record.get("requested_state")
    return record["status"] + (f", to be {requested}" if requested else "")


def status_and_reason(record: Mapping[str, Any]) -> str:
    reason = record.get("waiting_reason") or record.get("error")
    return status_of(record) + (f": {reason}" if reason else "")


def counts_as_text(counts: Mapping[str, int]) -> str:
    """Format the number of runs by status."""
    return ", ".join(f"{count} {status}" for status, count in counts.items() if count)


def done(record: Mapping[str, Any]) -> str:
    unit = record.get("unit", "generations")
    return f"{record['generation']}/{record['generations']} {unit}"


def speed(record: Mapping[str, Any]) -> str:
    """Format the rate of a run and its remaining time."""
    rate, remaining = record.get("evaluations_per_second"), record.get("eta_seconds")
    parts = [f"{rate:.3g} evaluations/s"] if rate and record["status"] == "running" else []
    parts += [f"{duration(remaining)} left"] if remaining is not None else []
    return "   ".join(parts)
