"""The report of a generation: figures and their catalogue, new elites, new rows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

Value = float | int | str | bool | None


@dataclass(frozen=True)
class Elite:
    """A creature that entered the archive; its identity is the canonical JSON."""

    cell: int
    fitness: float
    """Fitness by which it competes."""
    descriptors: tuple[float, ...]
    """In raw units, in the order of the archive's axes."""
    measures: dict[str, float]
    """Results of the first evaluation, which the same program repeats."""
    creature: str
    identity: bytes
    parents: tuple[str, ...]
    operator: str
    generation: int
    measured: dict[str, Any]
    provenance: dict[str, Any]
    poses: bytes | None = None
    """Its pose stream, as `archive.poses` encodes it."""


@dataclass(frozen=True)
class Row:
    """A line of a run's result, and its creature, if it has one."""

    values: Mapping[str, Value]
    creature: str | None = None
    identity: bytes | None = None
    measured: Mapping[str, Any] | None = None
    provenance: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class Report:
    """The run after a generation; counts are of the whole run so far.

    A search reports on its archive, other experiments the rows of their result.
    """

    generation: int
    evaluations: int
    infeasible: int
    qd_score: float | None = None
    coverage: float | None = None
    best: float | None = None
    mean: float | None = None
    elites: tuple[Elite, ...] = ()
    emptied: tuple[int, ...] = ()
    """Places that lost their elite in this generation and have no new one."""
    rows: tuple[Row, ...] = ()
    summary: Mapping[str, float | None] | None = None
    """Further figures of the generation or the result so far, by names of `FIGURES`."""


@dataclass(frozen=True)
class Figure:
    """A kind of figure in a summary. A `*` in its name stands for a name that runs choose."""

    name: str
    title: str
    adds: bool = False
    """True: figures of several generations add up. False: the newest counts."""
    curve: bool = True
    """The figure makes a curve; others are read one generation at a time."""

    def key(self, name: str) -> str | None:
        """Return what `*` stands for in a name, "" without `*`; None for another figure."""
        head, star, tail = self.name.partition("*")
        if not star:
            return "" if name == self.name else None
        inside = name.startswith(head) and name.endswith(tail)
        return name[len(head) : len(name) - len(tail)] if inside else None

    def of(self, summary: Mapping[str, float | None] | None) -> dict[str, float]:
        """Return the figures of this kind, by what `*` stands for."""
        keys = ((self.key(name), value) for name, value in (summary or {}).items())
        return {key: value for key, value in keys if key is not None and value is not None}


INSERTED = Figure("emitter.*.inserted", "offspring of an emitter that filled an empty cell")
IMPROVED = Figure("emitter.*.improved", "offspring of an emitter that replaced an elite")
INFEASIBLE = Figure("infeasible.*", "infeasible evaluations, by reason", adds=True)
SPECIES = Figure("species.*", "members of a species, by its number", curve=False)
ENDED = Figure("ended.*", "generation of an early end, by the limit that was met", curve=False)
FIGURES = (
    Figure("device_seconds", "time on the device"),
    Figure("clipped", "evaluations outside the range of an axis"),
    Figure("emitter.*.children", "offspring of an emitter, or of the `chosen`"),
    *(INSERTED, IMPROVED, INFEASIBLE, SPECIES, ENDED),
    Figure("corrected_qd_score", "QD score of the elites, evaluated again"),
    Figure("corrected_coverage", "coverage of the elites, evaluated again"),
    Figure("hit_rate", "share of the elites that stay in their cell, evaluated again"),
    Figure("motion_distance", "mean distance of the motions of elites, after the last"),
    Figure("nearest_motion", "mean distance to the nearest motion of an elite"),
    Figure("kinds", "kinds of motion of the elites"),
    Figure("epoch", "number of times that axes were learned"),
    Figure("explained_variance", "share of the variance along the learned axes"),
    Figure("displaced", "elites that lost their place to learned axes"),
    Figure("moqd_score", "sum over cells of the hypervolume of their fronts"),
    Figure("hypervolume", "hypervolume of the front of all elites"),
    Figure("largest_sum", "largest sum of fitness and second objective"),
    Figure("mean_length", "elites for each cell that has one"),
    Figure("predicted.*", "errors of the predictions that screened offspring"),
    Figure("slopes.finite", "share of creatures whose slopes are finite"),
    Figure("slopes.length", "median length of the slopes of fitness"),
    Figure("cluster.devices", "devices of the cluster"),
    Figure("cluster.efficiency", "share of the time that they were busy"),
    Figure("loss", "mean loss of a folding"),
    Figure("loss.*", "loss of a filament, by its picture"),
    Figure("before", "fitness before a refinement"),
    Figure("fitness", "fitness after a step of a refinement"),
    Figure("length", "length of its next step"),
    Figure("points", "points of a table of gaits"),
    Figure("failed", "points that failed"),
    Figure("warned", "points with warnings"),
    Figure("exponent", "growth of time with nodes"),
    Figure("exponent_from", "least nodes that it is measured from"),
    Figure("exponent_all_pairs", "the same where all pairs of nodes are compared"),
    Figure("peak_memory_bytes", "most memory"),
)
"""All figures of summaries."""


def figure(name: str) -> Figure | None:
    """Return the declaration of a figure; None for a name that is not declared."""
    return next((one for one in FIGURES if one.key(name) is not None), None)


def curves_of(summary: Mapping[str, Any] | None) -> dict[str, float]:
    """Return the numbers of a summary that make curves."""
    return {
        name: value
        for name, value in (summary or {}).items()
        if type(value) in (int, float) and ((known := figure(name)) is None or known.curve)
    }
