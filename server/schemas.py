"""Wire types: what the API takes and gives. Rows are in `models`."""

from datetime import datetime
from typing import Annotated, Any, Literal
from uuid import UUID

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

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


class PaceRead(Wire):
    """How fast earlier runs of the same kind were, on a device that there is."""

    device: str
    runs: int
    cell_steps_per_second: float
    low: float
    """Seconds at the pace of the fastest of those runs."""
    high: float
    """Seconds at the pace of the slowest."""


class AheadRead(Wire):
    waiting: int
    """Runs that go before it: those in the queue that no worker is about to begin."""
    workers: int
    free: int
    """Workers that have nothing to do."""


class BodyRead(Wire):
    """A body at rest in its world; of one with many nodes some are left out."""

    name: str
    nodes: int
    """How many there are."""
    positions: list[list[float]]
    """[x, y] in cells."""
    edges: list[list[int]]
    whole: bool
    """Whether every filament is drawn."""


class PictureRead(Wire):
    name: str
    width: int
    height: int
    pixels: str
    """Base64 of one byte a pixel, row by row from the top; 255 is ink."""


class DrawingRead(Wire):
    """Bodies, each in a world of its own, and the pictures that they are to become."""

    width: int
    height: int
    bodies: list[BodyRead]
    pictures: list[PictureRead]
    picture_size: int
    """The longer side of a picture, in cells."""


class EstimateRead(Wire):
    memory_bytes: int
    memory_limit_bytes: int
    evaluations: int
    cell_steps: int
    seconds: float | None
    """None where no run of the kind was measured on a device that there is."""
    pace: PaceRead | None
    """What the seconds rest on."""
    queue: AheadRead
    drawing: DrawingRead


def distinct(tags: list[str]) -> list[str]:
    twice = next((tag for tag in tags if tags.count(tag) > 1), None)
    if twice is not None:
        raise ValueError(f"needs tags that differ; got {twice!r} more than once")
    return tags


NAME = 200
Tag = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=50)]
Tags = Annotated[list[Tag], Field(max_length=20), AfterValidator(distinct)]


class RunChange(Wire):
    """What people may say of a run; what is left out stays as it is."""

    name: Annotated[str, StringConstraints(strip_whitespace=True, max_length=NAME)] | None = (
        None
    )
    tags: Tags = []
    note: Annotated[str, StringConstraints(max_length=10_000)] | None = None

    def said(self) -> dict[str, Any]:
        """By field; text without anything in it is none."""
        said = self.model_dump(exclude_unset=True)
        return {
            field: value if field == "tags" else value or None for field, value in said.items()
        }


class RunRead(Wire):
    id: UUID
    experiment: str
    name: str | None
    tags: list[str]
    note: str | None
    status: Status
    wish: Literal["pause", "cancel"] | None
    waiting: str | None
    """Why nobody carries it out yet, in words; None unless it is queued."""
    spec: dict[str, Any]
    created_at: datetime
    queued_at: datetime
    """When it last began to wait for a worker."""
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


class Species(Wire):
    """Columns, one entry for each generation that tells its species, those that live."""

    generation: list[int]
    number: list[list[int]]
    """No two species of a run ever have the same."""
    members: list[list[int]]


class Target(Wire):
    """A picture that a filament folds into, made as large as the filament sees it."""

    name: str
    width: int
    height: int
    size: int
    """Cells of its longer side; it lies in the middle of the world."""
    pixels: str
    """Base64 of one byte a pixel, row by row from the top; 255 is ink."""


class EntryRead(Wire):
    """What happened to a run."""

    id: int
    at: datetime
    level: Literal["info", "warning", "error"]
    attempt: int
    """Before the first one it is 0."""
    text: str


class Log(Wire):
    entries: list[EntryRead]


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


class HistoryRead(Wire):
    """Columns, one entry for each elite that ever entered, in the order of generations."""

    generation: int
    cell: list[int]
    fitness: list[float]
    descriptors: list[list[float]]
    elite_generation: list[int]
    creature: list[str]
    features: dict[str, list[float | None]]
    """Columns of the features that were asked for."""


class CentroidsRead(Wire):
    """Where the cells of a CVT archive are, from 0 to 1 along each axis on its own scale."""

    centroids: list[list[float]]


class ResultsRead(Wire):
    """The table that is a run's result; each row names its `creature`, if it has one."""

    generation: int
    summary: dict[str, Any] | None
    rows: list[dict[str, Any]]


class Relative(Wire):
    """Somebody in a creature's lineage."""

    creature: str
    distance: int
    """Generations between the two."""
    kept: bool
    """Whether it ever was an elite; of others nothing but the name is known."""
    parents: list[str]
    operator: str | None
    generation: int | None
    fitness: float | None


class Ancestors(Wire):
    parents: list[str]
    """Of the creature itself."""
    items: list[Relative]
    """Nearest first."""
    more: bool
    """Whether there are others, older than was asked for or too many for one answer."""


class Children(Wire):
    total: int
    items: list[Relative]
    """Best first; those that were never measured come last."""


class CreatureName(Wire):
    creature: str


class Rendering(Wire):
    status: Literal["rendering"] = "rendering"


class Carried(Wire):
    """A run as it is named beside a worker or in the queue."""

    id: UUID
    experiment: str
    name: str | None
    demonstration: bool
    status: Status
    generation: int
    generations: int
    progress: float
    attempt: int


class WorkerRead(Wire):
    name: str
    device: str
    kind: Literal["cpu", "gpu"]
    memory_bytes: int
    """Of the machine, or of the GPU."""
    memory_used_bytes: int | None
    load: float | None
    """Of the machine, over a minute and for each core; or of the GPU. 1 is fully busy."""
    status: Literal["idle", "busy"]
    since: datetime
    """When its status or its run last changed."""
    run: UUID | None
    carries: Carried | None
    """The run that it is at."""
    heartbeat_at: datetime


class TagRead(Wire):
    tag: str
    runs: int
    """How many have it."""


class Waiting(Carried):
    waiting: str
    """Why it waits, in words."""
    queued_at: datetime
    memory_bytes: int | None
    """What it needs, as far as can be said."""


class QueueRead(Wire):
    total: int
    """Among them those that a worker is about to begin."""
    items: list[Waiting]
    """The first ones, in the order in which they will be taken."""


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
