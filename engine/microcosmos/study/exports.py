"""The exports of a study: tables of its comparisons, and files of its runs."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..archive import export
from ..archive.atomic import write_whole
from ..archive.file import load
from ..archive.poses import streams
from ..statistics import tables
from .document import file_of
from .results import Results

Files = dict[str, bytes]


def save(results: Results, folder: Path) -> list[Path]:
    """Write the exports that the study lists; return the paths."""
    written = []
    for name in results.plan.study.exports:
        for file, data in _EXPORTS[name](results).items():
            path = folder / file
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, data)
            written.append(path)
    return written


def _table(suffix: str, write: Callable[..., str]) -> Callable[[Results], Files]:
    """Return an export of every comparison; those over tasks are JSON alone."""

    def made(results: Results) -> Files:
        found: Files = {}
        for name, one in results.comparisons.items():
            if one.statistics:
                found[f"{file_of(name)}.{suffix}"] = write(one.statistics).encode()
            elif suffix == "json":
                found[f"{file_of(name)}.json"] = tables.aggregates_json(one.aggregates).encode()
        return found

    return made


def _archives(results: Results) -> Files:
    """Return pyribs' table of every archive."""
    return {f"archives/{id}.csv": export.csv(x.data).encode() for id, x in results.runs.items()}


def _poses(results: Results) -> Files:
    """Return the poses of the fittest creature of every run that has elites."""
    found = {}
    for id, one in results.runs.items():
        tree, attributes = load(one.data)
        fitness = tree["archive"]["fitness"]
        if len(fitness):
            best = streams(tree, attributes)[int(np.argmax(fitness))]
            found[f"poses/{id}.npz"] = best.npz()
    return found


_EXPORTS: dict[str, Callable[[Results], Files]] = {
    "csv": _table("csv", tables.csv),
    "json": _table("json", tables.json),
    "latex": _table("tex", tables.latex),
    "archive-csv": _archives,
    "poses-npz": _poses,
}
