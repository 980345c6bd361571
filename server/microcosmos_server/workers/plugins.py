"""Versions of plug-ins that runs need and workers have."""

from collections.abc import Sequence
from typing import Any

from microcosmos.spec import plugins_in

from ..tables import Worker


def needed_versions(document: Any) -> list[str] | None:
    """Return the versions that a worker must have for a spec; None if there are none."""
    return sorted({one.version.source for one in plugins_in(document)}) or None


def versions_of(worker: Worker) -> set[str]:
    return {one["source"] for one in worker.plugins}


def has_versions(worker: Worker | None, needed: Sequence[str] | None) -> bool:
    """Return whether a worker has all versions that a run needs."""
    return not needed or (worker is not None and set(needed) <= versions_of(worker))


def explain_missing(alive: Sequence[Worker], document: Any) -> str:
    """Return a sentence about a run that none of the live workers can compute."""
    absent = {
        one.name: one.version.source
        for one in plugins_in(document)
        if not any(one.version.source in versions_of(worker) for worker in alive)
    }
    if not absent:
        return "Waits for a worker that has all of its plug-ins; none has them together."
    names = ", ".join(f"{name} (version {source[:12]})" for name, source in absent.items())
    others = sorted(
        {
            worker.name
            for worker in alive
            for one in worker.plugins
            if one["name"] in absent and one["source"] != absent[one["name"]]
        }
    )
    have = f"; {', '.join(others)} has another version" if others else ""
    return f"Waits for a worker that has {names}: no live worker does{have}."
