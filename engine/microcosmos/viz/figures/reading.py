"""Archive files for figures, read with NumPy alone: elites, axes, labels, groups."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ...archive import file, measured
from ...archive.export import tessellation
from ...archive.export import unit as place_on
from ...archive.measured import described
from ...measures import MEASURES
from ...spec import Descriptor, Neuroevolution, PluginVersion, QualityDiversity, parse
from ...spec.paths import IGNORED, differing, flattened, label
from ...spec.search import MEASURED
from ...statistics.groups import Group, distinct, in_order, spec_key

Search = QualityDiversity | Neuroevolution
"""The specs whose runs fill an archive."""


class Described(Protocol):
    """A run as captions and labels need it: an archive, or a run's record of statistics."""

    @property
    def spec(self) -> Any: ...
    @property
    def curves(self) -> Any: ...
    @property
    def version(self) -> str: ...
    @property
    def devices(self) -> tuple[str, ...]: ...


def plugins_of(spec: Search) -> dict[str, PluginVersion]:
    """Return versions of the plug-ins among the measures, by name."""
    task = spec.task
    return spec.archive.plugins | ({task.fitness: task.plugin} if task.plugin else {})


@dataclass(frozen=True, eq=False)
class Archive:
    """The elites of a run, its curves and its lineage."""

    spec: Search
    version: str
    devices: tuple[str, ...]
    """Kinds of device that computed it, in order."""
    measures: dict[str, np.ndarray]
    """Measures of each elite, by name."""
    cells: np.ndarray
    """The cell of each elite; with a container its place, which does not tell where it lies."""
    fitness: np.ndarray
    centroids: np.ndarray | None
    """(cell, axis) from 0 to 1 on the axes' own scales; None for a grid or a container."""
    curves: dict[str, np.ndarray]
    lineage: dict[str, np.ndarray]
    """Columns with an entry for each creature that entered the archive, in order."""

    @property
    def axes(self) -> tuple[Descriptor, ...]:
        return self.spec.archive.descriptors

    @property
    def pool(self) -> bool:
        """Return whether a container numbers the places of elites, instead of cells."""
        return self.spec.archive.container is not None

    @property
    def best(self) -> int:
        """Return the row of the fittest elite."""
        return int(np.argmax(self.fitness))

    @cached_property
    def document(self) -> dict[str, Any]:
        return self.spec.model_dump(mode="json")

    @property
    def seed(self) -> int:
        return self.spec.seed

    @property
    def fields(self) -> dict[str, Any]:
        """Return every value of the spec by its dotted path."""
        return dict(flattened(self.document))

    def row(self, cell: int | None) -> int:
        """Return the row of a cell's elite; None: the fittest. `ValueError` if empty."""
        if cell is None:
            return self.best
        rows = np.flatnonzero(self.cells == cell)
        if not len(rows):
            raise ValueError(
                f"`cell` must be one of the {len(self.cells)} that have an elite, from "
                f"{self.cells.min()} to {self.cells.max()}; got {cell}"
            )
        return int(rows[0])


def read(data: bytes) -> Archive:
    """Return the archive in a run's file. Raises `ValueError` if it is missing or empty."""
    tree, attributes = file.load(data)
    spec = parse(json.loads(attributes["spec"]))
    if "archive" not in tree or not isinstance(spec, Search):
        table = f"the table of {spec.experiment!r}"
        raise ValueError(f"an archive is needed, as searches have; got {table}")
    archive = tree["archive"]
    if not len(archive["cell"]):
        raise ValueError("an archive with an elite is needed, got one without")
    return Archive(
        spec=spec,
        version=attributes["version"],
        devices=tuple(json.loads(attributes["device"])),
        measures=measured.columns(tree, attributes),
        cells=archive["cell"],
        fitness=archive["fitness"].astype(float),
        centroids=tessellation(archive, json.loads(attributes["spec"])["archive"]),
        curves=tree["curves"],
        lineage=tree["lineage"],
    )


def grouped(runs: Sequence[Archive]) -> list[Group]:
    """Group runs in the order of the first ones. Raises `ValueError` for a run given twice."""
    alike: dict[tuple, list[Archive]] = {}
    for run in runs:
        alike.setdefault(spec_key(run.fields, IGNORED), []).append(run)
    for same in alike.values():
        seeds = [run.seed for run in same]
        if len(set(seeds)) < len(seeds):
            twice = next(seed for seed in seeds if seeds.count(seed) > 1)
            raise ValueError(f"`FILE` must differ in spec or seed, got seed {twice} twice.")
    paths = differing([same[0].fields for same in alike.values()])
    names = distinct([label(same[0].fields, paths) for same in alike.values()])
    return [
        Group(name, in_order(same)) for name, same in zip(names, alike.values(), strict=True)
    ]


def spread(runs: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return lower quartile, median and upper quartile, up to the end of the shortest run.

    They are not finite where they lie among infinite values.
    """
    length = min(map(len, runs))
    values = np.stack([run[:length] for run in runs])
    # Between infinite values, of archives without elites, NumPy finds NaN and warns.
    with np.errstate(invalid="ignore"):
        return tuple(np.quantile(values, (0.25, 0.5, 0.75), axis=0))


BINS = 24
"""Bins of an axis that is not a grid's, as on the page."""


@dataclass(frozen=True)
class Axis:
    """One measure with its ends; places run from 0 to 1 on its own scale."""

    name: str
    label: str
    low: float
    high: float
    logarithmic: bool
    bins: int

    def places(self, values: np.ndarray) -> np.ndarray:
        """Return places of values, cut at the ends."""
        scale = "log10" if self.logarithmic else "linear"
        own = {"low": self.low, "high": self.high, "scale": scale}
        return np.clip(place_on(np.asarray(values, np.float64), own), 0, 1)

    def values(self, places: np.ndarray) -> np.ndarray:
        """Return values of places; the inverse of `places`."""
        low, high = self.low, self.high
        if self.logarithmic:
            return 10 ** (np.log10(low) + places * (np.log10(high) - np.log10(low)))
        return low + places * (high - low)

    @property
    def edges(self) -> np.ndarray:
        return self.values(np.linspace(0, 1, self.bins + 1))


def measure_label(archive: Described, name: str) -> str:
    """Return the title and unit of a measure; a plug-in declares its own."""
    return described(name, plugins_of(archive.spec)).label


def fitness_label(archive: Described) -> str:
    task = archive.spec.task
    if task.fitness == "displacement+energy":
        return f"Displacement + {task.energy_weight:g} × energy [cells]"
    name, sign = MEASURED.get(task.fitness, (task.fitness, 1))
    return ("−" if sign < 0 else "") + measure_label(archive, name)


def chosen(archive: Archive, names: list[str] | None) -> list[Axis]:
    """Return the named axes; by default the archive's first two, or its only one."""
    own = {axis.name: axis for axis in archive.axes}
    names = names or list(own)[:2]
    if not 1 <= len(names) <= 2 or len(set(names)) < len(names):
        raise ValueError(f"`axes` must be one or two that differ, got {', '.join(names)}.")
    for name in names:
        if name not in archive.measures:
            raise ValueError(
                f"`axes` must be of {', '.join(own)} (the archive's own) or what else was "
                f"measured ({', '.join(n for n in archive.measures if n not in own)}); "
                f"got {name!r}."
            )
    return [_axis(archive, name, own.get(name)) for name in names]


def _axis(archive: Archive, name: str, own: Descriptor | None) -> Axis:
    """Return the axis of a measure; without one of the archive's `own`, round its ends."""
    title = measure_label(archive, name)
    if own is not None:
        bins = own.bins if archive.centroids is None else BINS
        return Axis(name, title, own.low, own.high, own.scale == "log10", bins)
    known, values = MEASURES.get(name), archive.measures[name].astype(float)
    if known is not None and known.scale == "log10":
        logarithms = np.log10(np.clip(values, known.low, None))
        # A decade that is met but for rounding starts no further one.
        low, high = np.floor(logarithms.min() + 1e-9), np.ceil(logarithms.max() - 1e-9)
        return Axis(name, title, 10.0**low, 10.0 ** max(high, low + 1), True, BINS)
    least = max(np.ptp(values), 1e-9 * abs(values.max()), 1e-12) / 8
    power = 10.0 ** np.floor(np.log10(least))
    step = next(m * power for m in (1, 2, 5, 10) if m * power >= least * (1 - 1e-9))
    low = step * np.floor(values.min() / step + 1e-9)
    high = max(step * np.ceil(values.max() / step - 1e-9), low + step)
    return Axis(name, title, float(low), float(high), False, BINS)


def label_axes(panel: Any, axes: list[Axis]) -> None:
    """Set ends, scale and label of each axis of a panel."""
    from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

    for axis, which in zip(axes, "xy", strict=False):
        panel.set(**{f"{which}scale": "log" if axis.logarithmic else "linear"})
        panel.set(**{f"{which}lim": (axis.low, axis.high), f"{which}label": axis.label})
        ruler = getattr(panel, f"{which}axis")
        ruler.label.set_parse_math(False)  # Titles of plug-ins may have dollars.
        if axis.logarithmic:
            ruler.set_major_locator(LogLocator(10, numticks=9))
            ruler.set_minor_locator(LogLocator(10, subs=tuple(range(2, 10)), numticks=50))
            ruler.set_minor_formatter(NullFormatter())
        else:
            ruler.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
