"""Wire types of sweeps: request, state, summary and curves."""

from datetime import datetime
from typing import Annotated, Any
from uuid import UUID

from pydantic import BeforeValidator, Field, StringConstraints

from ..core.schemas import Wire
from ..estimates.eta import MeasuredSpeed
from ..estimates.position import QueueAhead
from ..runs.schemas import Name
from ..specs.schemas import SpecDocument
from ..tables import Status

MAX_RUNS = 1000
MAX_FIELDS = 16
SEEDS = 2**32


def seeds_sent(value: Any) -> Any:
    """Check a number of seeds, or a list of different seeds."""
    if _is_seed(value) and 1 <= value <= MAX_RUNS:
        return value
    if isinstance(value, list) and 1 <= len(value) <= MAX_RUNS and all(map(_is_seed, value)):
        twice = next((seed for seed in value if value.count(seed) > 1), None)
        if twice is not None:
            raise ValueError(f"needs seeds that differ; got {twice} more than once")
        return value
    got = f"{value!r:.80}"
    raise ValueError(
        f"needs a number of seeds from 1 to {MAX_RUNS:,}, or a list of up to {MAX_RUNS:,} "
        f"whole numbers from 0 to {SEEDS - 1}; got {got}"
    )


def _is_seed(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < SEEDS


Count = Annotated[int, Field(ge=1, le=MAX_RUNS)]
Seed = Annotated[int, Field(ge=0, lt=SEEDS)]
Listed = Annotated[list[Seed], Field(min_length=1, max_length=MAX_RUNS)]
Path = Annotated[str, StringConstraints(min_length=1, max_length=200)]
Values = Annotated[list[Any], Field(min_length=1, max_length=MAX_RUNS)]


class SweepCreate(Wire):
    """A request for many runs: each case of the grid with each seed."""

    spec: SpecDocument
    seeds: Annotated[Count | Listed, BeforeValidator(seeds_sent)] = 1
    """A number of seeds, starting with the spec's own, or a list of seeds."""
    grid: Annotated[dict[Path, Values], Field(max_length=MAX_FIELDS)] = Field(default={})
    """Values by the dotted path of a field, as `archive.descriptors.0.bins`."""
    name: Name | None = None


class SweepChange(Wire):
    """New name of a sweep; an empty one removes the name."""

    name: Name | None


class CaseRead(Wire):
    """One combination of the grid's values."""

    values: dict[str, Any]
    runs: list[UUID]
    """One for each seed, in the order of the seeds, without deleted ones."""


class SweepBrief(Wire):
    id: UUID
    name: str | None
    experiment: str
    spec: dict[str, Any]
    seeds: list[int]
    grid: dict[str, list[Any]]
    created_at: datetime
    owner: str | None
    total: int
    deleted: int
    """Number of runs in the bin, which no other field counts."""
    status_counts: dict[Status, int]
    """Numbers of runs by state, without zeros."""
    progress: float


class SweepRead(SweepBrief):
    cases: list[CaseRead]
    """Each with its values, which may be long: lists omit them."""


class SweepPage(Wire):
    items: list[SweepBrief]
    next: str | None


class SkippedRun(Wire):
    """A run that did not change, with the reason."""

    run: UUID
    status: Status
    reason: str


class SweepRuns(Wire):
    """Runs of a sweep, such as those that an action changed."""

    runs: list[UUID] = Field(max_length=10_000)


class SweepChanged(SweepRead):
    changed: list[UUID]
    """The runs that changed, or that their workers will change."""
    skipped: list[SkippedRun]


class SweepEstimate(Wire):
    runs: int
    cases: int
    memory_bytes: int
    """Memory of the largest run."""
    memory_limit_bytes: int
    evaluations: int
    """Sum over all runs, as the next two fields."""
    cell_steps: int
    seconds: float | None
    """Total time of all runs, one after the other; None if one has no estimate."""
    speed: MeasuredSpeed | None
    """The measured speed behind the estimate of the first case."""
    queue: QueueAhead


class Spread(Wire):
    """Median, quartiles and range of the known values."""

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
    """A `Spread` at each generation, as columns."""

    median: list[float | None]
    low: list[float | None]
    high: list[float | None]
    min: list[float | None]
    max: list[float | None]


class SweepRun(Wire):
    """A run of a sweep in short."""

    run: UUID
    seed: int | None
    status: Status
    generation: int
    generations: int
    face: str | None
    """The best creature of the run."""
    best: float | None
    """The fitness of that creature."""


class CaseSummary(Wire):
    """Statistics over the runs of a case; columns have one entry per generation."""

    values: dict[str, Any]
    members: list[SweepRun]
    generation: list[int]
    runs: list[int]
    """Number of runs that have reached the generation."""
    qd_score: Quantiles
    coverage: Quantiles
    best: Quantiles
    finals: dict[str, Final]
    """Each figure at the sweep's common generation."""


class SweepSummary(Wire):
    id: UUID
    generation: int | None
    """The generation at which `finals` compares the runs; all active ones have reached it."""
    cases: list[CaseSummary]


class RunCurves(Wire):
    """The curves of one run; None after its last recorded generation."""

    run: UUID
    qd_score: list[float | None]
    coverage: list[float | None]
    best: list[float | None]


class SweepCurves(Wire):
    generation: list[int]
    runs: list[RunCurves]
