"""Archives: who is in which cell, now and before."""

from typing import Any, Literal

from ..core.schemas import Wire


class Axis(Wire):
    name: str
    low: float
    high: float
    bins: int
    scale: Literal["log10", "linear"]


class Measure(Wire):
    """What is recorded of every elite, and where an axis of it begins and ends by default."""

    name: str
    title: str
    unit: str
    low: float | None
    high: float | None
    scale: Literal["log10", "linear"]


class ArchiveRead(Wire):
    """Columns, one entry per filled cell.

    The cells of a grid are numbered in C order over the bins of its axes; those of a CVT in
    the order of their centroids, and the bins of its axes are none.
    """

    generation: int
    kind: Literal["grid", "cvt"]
    cells: int
    axes: list[Axis]
    recorded: list[Measure]
    cell: list[int]
    fitness: list[float]
    descriptors: list[list[float]]
    elite_generation: list[int]
    creature: list[str]
    measures: dict[str, list[float | None]]
    """Columns of the measures that were asked for."""


class HistoryRead(Wire):
    """Columns, one entry for each elite that ever entered, in the order of generations."""

    generation: int
    cell: list[int]
    fitness: list[float]
    descriptors: list[list[float]]
    elite_generation: list[int]
    creature: list[str]
    measures: dict[str, list[float | None]]
    """Columns of the measures that were asked for."""


class CentroidsRead(Wire):
    """Where the cells of a CVT archive are, from 0 to 1 along each axis on its own scale.

    Null before the first checkpoint.
    """

    centroids: list[list[float]] | None


class ResultsRead(Wire):
    """The table that is a run's result; each row names its `creature`, if it has one."""

    generation: int
    summary: dict[str, Any] | None
    rows: list[dict[str, Any]]
