"""Sweeps: what is asked for, how it stands, and what its runs say together."""

from datetime import datetime
from typing import Annotated, Any
from uuid import UUID

from pydantic import BeforeValidator, Field, StringConstraints

from ..core.schemas import Wire
from ..estimates.schemas import MeasuredSpeed, QueueAhead
from ..runs.schemas import Name
from ..tables import Status

MOST = 1000
"""Runs that one request may ask for."""
FIELDS = 16
"""Fields of a spec that a grid may run over."""
SEEDS = 2**32


def seeds_sent(value: Any) -> Any:
    """How many, or which: numbers that differ."""
    if _is_seed(value) and 1 <= value <= MOST:
        return value
    if isinstance(value, list) and 1 <= len(value) <= MOST and all(map(_is_seed, value)):
        twice = next((seed for seed in value if value.count(seed) > 1), None)
        if twice is not None:
            raise ValueError(f"needs seeds that differ; got {twice} more than once")
        return value
    got = f"{value!r:.80}"
    raise ValueError(
        f"needs a number of seeds from 1 to {MOST:,}, or a list of so many whole numbers from "
        f"0 to {SEEDS - 1}; got {got}"
    )


def _is_seed(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < SEEDS


Count = Annotated[int, Field(ge=1, le=MOST)]
Seed = Annotated[int, Field(ge=0, lt=SEEDS)]
Listed = Annotated[list[Seed], Field(min_length=1, max_length=MOST)]
Path = Annotated[str, StringConstraints(min_length=1, max_length=200)]
Values = Annotated[list[Any], Field(min_length=1, max_length=MOST)]


class SweepSent(Wire):
    """One request for many runs: each case of the grid with each seed."""

    spec: dict[str, Any]
    seeds: Annotated[Count | Listed, BeforeValidator(seeds_sent)] = 1
    """So many from the spec's own on, or those in a list."""
    grid: Annotated[dict[Path, Values], Field(max_length=FIELDS)] = Field(default={})
    """Values by the dotted path of a field, as `archive.descriptors.0.bins`."""
    name: Name | None = None


class SweepChange(Wire):
    """What a sweep is called; without anything in it, it has no name."""

    name: Name | None


class CaseRead(Wire):
    """One combination of the grid's values."""

    values: dict[str, Any]
    runs: list[UUID]
    """One for each seed, in the order of the seeds, as far as they were not deleted."""


class SweepRead(Wire):
    id: UUID
    name: str | None
    experiment: str
    spec: dict[str, Any]
    seeds: list[int]
    """None where the experiment has no seed."""
    grid: dict[str, list[Any]]
    created_at: datetime
    owner: str | None
    """The name of the token it was made with."""
    cases: list[CaseRead]
    total: int
    deleted: int
    """Its runs in the bin, which are not counted anywhere else."""
    status_counts: dict[Status, int]
    """How many runs are in each state that any is in."""
    progress: float


class SweepPage(Wire):
    items: list[SweepRead]
    next: str | None


class SkippedRun(Wire):
    """A run that was left as it is."""

    run: UUID
    status: Status
    reason: str


class SweepChanged(SweepRead):
    changed: list[UUID]
    """The runs that did what was asked, or will."""
    skipped: list[SkippedRun]


class SweepEstimate(Wire):
    runs: int
    cases: int
    memory_bytes: int
    """Of the run that needs most."""
    memory_limit_bytes: int
    evaluations: int
    """Of all runs together, as the following."""
    cell_steps: int
    seconds: float | None
    """One run after the other; None where any kind of them was not measured yet."""
    speed: MeasuredSpeed | None
    """What the seconds of the first case rest on."""
    queue: QueueAhead


class Spread(Wire):
    """Of the values that are known."""

    median: float | None
    low: float | None
    """A quarter of the values are lower."""
    high: float | None
    """A quarter of the values are higher."""
    min: float | None
    max: float | None


class Final(Spread):
    values: list[float | None]
    """One for each of the case's runs, in their order."""


class Quantiles(Wire):
    """A spread at each generation, as columns."""

    median: list[float | None]
    low: list[float | None]
    high: list[float | None]
    min: list[float | None]
    max: list[float | None]


class SweepRun(Wire):
    """A run as its sweep tells of it."""

    run: UUID
    seed: int | None
    status: Status
    generation: int
    generations: int


class CaseSummary(Wire):
    """What the runs of one case say together; columns have one entry per generation."""

    values: dict[str, Any]
    members: list[SweepRun]
    generation: list[int]
    runs: list[int]
    """How many have got so far."""
    qd_score: Quantiles
    coverage: Quantiles
    best: Quantiles
    finals: dict[str, Final]
    """Each figure at the sweep's common generation."""


class SweepSummary(Wire):
    id: UUID
    generation: int | None
    """The generation at which `finals` compares the runs: all active ones have reached it.
    None before the first."""
    cases: list[CaseSummary]


class RunCurves(Wire):
    """The curves of one run; None beyond the last generation that it has recorded."""

    run: UUID
    qd_score: list[float | None]
    coverage: list[float | None]
    best: list[float | None]


class SweepCurves(Wire):
    generation: list[int]
    runs: list[RunCurves]
