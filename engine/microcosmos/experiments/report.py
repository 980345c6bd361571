"""What an experiment tells about a generation."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Elite:
    """A creature that entered the archive; its identity is the canonical JSON."""

    cell: int
    fitness: float
    descriptors: tuple[float, ...]
    """In raw units, in the order of the archive's axes."""
    features: dict[str, float]
    creature: str
    identity: bytes
    parents: tuple[str, ...]
    operator: str
    generation: int
    measured: dict[str, Any]
    provenance: dict[str, Any]


@dataclass(frozen=True)
class Report:
    """The archive after a generation; counts are of the whole run so far."""

    generation: int
    qd_score: float
    coverage: float
    best: float
    mean: float
    evaluations: int
    diverged: int
    elites: tuple[Elite, ...]
