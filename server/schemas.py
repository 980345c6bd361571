"""Wire types: what the API takes and gives. Rows are in `models`."""

from datetime import datetime
from typing import Any, Literal
from uuid import UUID

from pydantic import BaseModel, ConfigDict

Status = Literal["queued", "running", "paused", "finished", "failed", "cancelled"]


class Wire(BaseModel):
    model_config = ConfigDict(extra="forbid", from_attributes=True)


class PresetRead(Wire):
    name: str
    title: str
    spec: dict[str, Any]


class ExperimentRead(Wire):
    experiment: str
    title: str
    schema_: dict[str, Any]
    presets: list[PresetRead]

    model_config = ConfigDict(
        extra="forbid",
        populate_by_name=True,
        serialize_by_alias=True,
        alias_generator=lambda name: name.rstrip("_"),
    )


class EstimateRead(Wire):
    memory_bytes: int
    memory_limit_bytes: int
    evaluations: int
    cell_steps: int


class RunRead(Wire):
    id: UUID
    experiment: str
    status: Status
    wish: Literal["pause", "cancel"] | None
    spec: dict[str, Any]
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    attempt: int
    generation: int
    generations: int
    progress: float
    eta_seconds: float | None
    evaluations: int
    evaluations_per_second: float | None
    qd_score: float | None
    coverage: float | None
    best: float | None
    summary: dict[str, Any] | None
    """Figures of the result as a whole, where it is a table."""
    diverged: int
    sparkline: list[float]
    """QD scores, evenly spaced over the generations so far."""
    error: str | None
    warning: str | None
    device: str | None
    version: str
    demonstration: bool


class RunPage(Wire):
    items: list[RunRead]
    next: str | None


class Curves(Wire):
    """Columns, one entry per generation."""

    generation: list[int]
    qd_score: list[float | None]
    coverage: list[float | None]
    best: list[float | None]
    mean: list[float | None]
    evaluations: list[int]
    diverged: list[int]
    seconds: list[float]
    summary: dict[str, list[float | None]]
    """Whatever other numbers the generations told: each the newest one since the point before,
    None where none was told."""


class Axis(Wire):
    name: str
    low: float
    high: float
    bins: int
    scale: Literal["log10", "linear"]


class Feature(Wire):
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
    recorded: list[Feature]
    cell: list[int]
    fitness: list[float]
    descriptors: list[list[float]]
    elite_generation: list[int]
    creature: list[str]
    features: dict[str, list[float | None]]
    """Columns of the features that were asked for."""


class ResultsRead(Wire):
    """The table that is a run's result; each row names its `creature`, if it has one."""

    generation: int
    summary: dict[str, Any] | None
    rows: list[dict[str, Any]]


class CreatureName(Wire):
    creature: str


class Rendering(Wire):
    status: Literal["rendering"] = "rendering"


class WorkerRead(Wire):
    name: str
    device: str
    memory_bytes: int
    status: str
    run: UUID | None
    heartbeat_at: datetime


class Health(Wire):
    status: Literal["ok"] = "ok"


class Readiness(Wire):
    database: Literal["ok", "unreachable"]
    redis: Literal["ok", "unreachable"]


class FieldError(Wire):
    field: str
    message: str
    needed: str | None = None
    got: Any = None


class Problem(BaseModel):
    """RFC 9457."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    errors: list[FieldError] | None = None
