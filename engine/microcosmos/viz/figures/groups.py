"""Groups of runs that differ in their seed alone, labelled by their differences."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...spec.differences import IGNORED, differing, flattened, label
from .reading import Archive


@dataclass(frozen=True, eq=False)
class Group:
    """Runs of one spec with different seeds."""

    label: str
    """Fields in which the group differs from the others."""
    runs: tuple[Any, ...]
    """Archives, or records of statistics: see `reading.Described`."""

    @property
    def seeds(self) -> list[int]:
        return [run.spec.seed for run in self.runs]


def grouped(runs: Sequence[Archive]) -> list[Group]:
    """Group runs in the order of the first ones. Raises `ValueError` for a run given twice."""
    found: dict[tuple, list[Archive]] = {}
    for run in runs:
        flat = dict(flattened(run.document))
        key = tuple(sorted((k, repr(v)) for k, v in flat.items() if k not in IGNORED))
        found.setdefault(key, []).append(run)
    for same in found.values():
        seeds = [run.spec.seed for run in same]
        if len(set(seeds)) < len(seeds):
            twice = next(seed for seed in seeds if seeds.count(seed) > 1)
            raise ValueError(f"`FILE` must differ in spec or seed, got seed {twice} twice.")
    flats = [dict(flattened(same[0].document)) for same in found.values()]
    labels = [label(flat, differing(flats)) for flat in flats]
    rows = [tuple(sorted(same, key=lambda run: run.spec.seed)) for same in found.values()]
    return list(map(Group, labels, rows))


def spread(runs: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return lower quartile, median and upper quartile, up to the end of the shortest run.

    They are not finite where they lie among infinite values.
    """
    length = min(map(len, runs))
    values = np.stack([run[:length] for run in runs])
    with np.errstate(invalid="ignore"):
        return tuple(np.quantile(values, (0.25, 0.5, 0.75), axis=0))
