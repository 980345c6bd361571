"""The report of a generation: figures, new elites, new rows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

Value = float | int | str | bool | None


@dataclass(frozen=True)
class Elite:
    """A creature that entered the archive; its identity is the canonical JSON."""

    cell: int
    fitness: float
    """That by which it competes: a mean where means decide."""
    descriptors: tuple[float, ...]
    """In raw units, in the order of the archive's axes; means where means decide."""
    measures: dict[str, float]
    """Of the first evaluation, as `measured`, which the same program repeats."""
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
    summary: Mapping[str, Value] | None = None
    """Further figures of the generation or the result so far."""
