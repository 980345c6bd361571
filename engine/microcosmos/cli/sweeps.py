"""The table of a sweep."""

from typing import Any

from ..client import Sweep
from .tables import shown

MEASURES = ("qd_score", "coverage", "best")


def members(sweep: "Sweep") -> list[dict[str, Any]]:
    """A row for each run."""
    return [{**row, "run": row["run"][:8]} for row in sweep.rows()]


def cases(sweep: "Sweep") -> list[dict[str, Any]]:
    """A row for each case: of each measure the median of its runs, as far as they have got,
    and a quarter to either side.
    """
    return [
        {
            **case["values"],
            "runs": len(case["members"]),
            "finished": sum(one["status"] == "finished" for one in case["members"]),
            **{name: _spread(case["finals"].get(name)) for name in MEASURES},
        }
        for case in sweep.summary().cases
    ]


def _spread(final: dict[str, Any] | None) -> dict[str, Any]:
    return {name: final[name] if final else None for name in ("median", "low", "high")}


def table(rows: list[dict[str, Any]]) -> None:
    names = list(dict.fromkeys(name for row in rows for name in row))
    shown(names, ([_cell(row.get(name)) for name in names] for row in rows))


def _cell(value: Any) -> str:
    if isinstance(value, dict) and "median" in value:
        if value["median"] is None:
            return "–"
        return f"{value['median']:.4g} ({value['low']:.4g} to {value['high']:.4g})"
    if value is None:
        return "–"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
