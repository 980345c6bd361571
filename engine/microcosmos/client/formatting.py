"""How numbers, times and runs are told to people."""

from collections.abc import Mapping
from typing import Any

FIGURES = (("QD score", "qd_score"), ("coverage", "coverage"), ("best", "best"))


def lasting(seconds: float | None) -> str:
    """A duration in its two largest units."""
    if seconds is None:
        return ""
    whole = max(0, round(seconds))
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    if whole < 86400:
        return f"{whole // 3600} h {whole % 3600 // 60} min"
    return f"{whole // 86400} d {whole % 86400 // 3600} h"


def sized(count: float) -> str:
    """Bytes in a unit that people read."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "B" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} TB"


def figure(name: str, value: float | None) -> str:
    if value is None:
        return "–"
    return f"{100 * value:.1f} %" if name == "coverage" else f"{value:.4g}"


def figures(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What a run has come to: of an archive its quality, of a table its summary."""
    if record.get("qd_score") is not None:
        return [(title, figure(name, record[name])) for title, name in FIGURES]
    summary = record.get("summary") or {}
    numbers = ((name, value) for name, value in summary.items() if type(value) in (int, float))
    return [(name.replace("_", " "), f"{value:.4g}") for name, value in list(numbers)[:4]]


def titled(record: Mapping[str, Any]) -> str:
    """What a run is called, and where it is found."""
    name = f" “{record['name']}”" if record.get("name") else ""
    return f"{record['experiment']}{name}  {record['id'][:8]}"


def standing(record: Mapping[str, Any]) -> str:
    """How a run is, with whatever keeps it from going on."""
    requested = record.get("requested_state")
    status = record["status"] + (f", to be {requested}" if requested else "")
    reason = record.get("waiting_reason") or record.get("error")
    return status + (f": {reason}" if reason else "")


def pace(record: Mapping[str, Any]) -> str:
    """How fast it goes and how long it will take."""
    rate, left = record.get("evaluations_per_second"), record.get("eta_seconds")
    said = [f"{rate:.3g} evaluations/s"] if rate and record["status"] == "running" else []
    return "   ".join([*said, *([f"{lasting(left)} left"] if left is not None else [])])
