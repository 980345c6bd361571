"""Groups of runs that differ in their seed alone, labelled by their differences."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .reading import Archive

IGNORED = ("seed",)
"""Fields that may differ within a group."""

MAX_FIELDS = 3
"""Maximum number of fields in a label."""


@dataclass(frozen=True, eq=False)
class Group:
    """Runs of one spec with different seeds."""

    label: str
    """Fields in which the group differs from the others."""
    runs: tuple[Archive, ...]

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
    labels = [_label(flat, differing(flats)) for flat in flats]
    rows = [tuple(sorted(same, key=lambda run: run.spec.seed)) for same in found.values()]
    return list(map(Group, labels, rows))


def flattened(document: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value of a spec with its dotted path."""
    if isinstance(document, Sequence) and any(isinstance(x, Mapping) for x in document):
        document = dict(enumerate(document))
    if not isinstance(document, Mapping):
        yield path, document
        return
    for name, part in document.items():
        yield from flattened(part, f"{path}.{name}" if path else str(name))


def differing(flats: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the paths whose values differ; only those that all specs have, if any."""
    paths = list(dict.fromkeys(path for flat in flats for path in flat if path not in IGNORED))
    other = [p for p in paths if len({repr(flat.get(p, "none")) for flat in flats}) > 1]
    shared = [path for path in other if all(path in flat for flat in flats)]
    return shared or other


def _label(flat: Mapping[str, Any], paths: Sequence[str]) -> str:
    parts = [f"{short(path)} {_value(flat.get(path, 'none'))}" for path in paths[:MAX_FIELDS]]
    return ", ".join(parts) + (" …" if len(paths) > MAX_FIELDS else "")


def short(path: str) -> str:
    """Return the last two words of a path, without indices."""
    words = [word for word in path.split(".") if not word.isdigit()]
    return " ".join(words[-2:]).replace("_", " ")


def _value(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Sequence) and not isinstance(value, str):
        text = ", ".join(map(_value, value))
        return text if len(text) <= 40 else text[:39] + "…"
    return "none" if value is None else str(value)


def spread(runs: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return lower quartile, median and upper quartile, up to the end of the shortest run."""
    length = min(map(len, runs))
    values = np.stack([run[:length] for run in runs])
    return tuple(np.quantile(values, (0.25, 0.5, 0.75), axis=0))
