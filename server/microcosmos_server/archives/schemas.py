"""Wire types of archives and of results that are tables."""

from typing import Any, Literal

from ..core.schemas import Wire


class Axis(Wire):
    name: str
    low: float
    high: float
    bins: int
    scale: Literal["log10", "linear"]


class Measure(Wire):
    """A measure that is recorded of every elite, with the default ends of an axis."""

    name: str
    title: str
    unit: str
    low: float | None
    high: float | None
    scale: Literal["log10", "linear"]
    bins: int | None = None
    """Bins along a learned axis; null for any other measure."""


class HistoryRead(Wire):
    """Columns, one entry for each elite that ever entered, in the order of generations."""

    generation: int
    cell: list[int]
    fitness: list[float]
    descriptors: list[list[float]]
    elite_generation: list[int]
    creature: list[str]
    emptied: list[int]
    """Cells that lost their elite without a new one."""
    emptied_generation: list[int]
    """The generation in which each of these cells lost its elite."""
    trusted: list[bool | None]
    """Verdicts of the creatures' audits; null for a creature without an audit."""
    measures: dict[str, list[float | None]]
    """Columns of the requested measures."""


class ArchiveRead(HistoryRead):
    """Columns, one entry per filled cell.

    The cells of a grid are numbered in C order over the bins of its axes. Those of a CVT are in
    the order of their centroids, and its axes have no bins. A pool, the archive of a run with a
    container, has numbered places instead of cells: the number does not tell where an elite
    lies. `emptied` are cells that are empty now.
    """

    kind: Literal["grid", "cvt", "pool"]
    cells: int
    coverage: float
    """Share of the cells over the axes that are filled, as recorded with the generation."""
    axes: list[Axis]
    recorded: list[Measure]


class CentroidsRead(Wire):
    """Centroids of a CVT archive, from 0 to 1 along each axis on its own scale.

    Null before the first checkpoint.
    """

    centroids: list[list[float]] | None


class ResultsRead(Wire):
    """The table that is a run's result; each row names its `creature`, if it has one."""

    generation: int
    summary: dict[str, Any] | None
    rows: list[dict[str, Any]]


class Component(Wire):
    """A principal component of all measures that are finite for every creature."""

    name: str
    explained: float
    """Share of the variance of these measures."""
    loadings: dict[str, float]
    """Correlation of each measure with the component, the strongest first."""


class Figures(Wire):
    """Figures of the cells that some creatures fill over some axes."""

    creatures: int
    elites: int
    coverage: float
    qd_score: float
    best: float | None


class ReprojectionRead(HistoryRead):
    """Columns, one entry for each creature that took a cell over the new axes.

    They are in the order of generations, so that each generation's archive follows. The cells
    are numbered in C order over the bins of the axes.
    """

    cells: int
    axes: list[Axis]
    components: list[Component]
    """The principal components among the axes."""
    all_time: Figures
    """All creatures that ever entered the archive."""
    present: Figures
    """The archive's present elites alone."""
