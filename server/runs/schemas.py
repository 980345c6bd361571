"""Runs, what people say of them, and their curves."""

from datetime import datetime
from typing import Annotated, Any, Literal, Self
from uuid import UUID

from pydantic import AfterValidator, Field, StringConstraints, model_validator

from ..core.schemas import Wire
from ..tables import Status

NAME = 200


def distinct(tags: list[str]) -> list[str]:
    twice = next((tag for tag in tags if tags.count(tag) > 1), None)
    if twice is not None:
        raise ValueError(f"needs tags that differ; got {twice!r} more than once")
    return tags


Tag = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=50)]

Tags = Annotated[list[Tag], Field(max_length=20), AfterValidator(distinct)]


Name = Annotated[str, StringConstraints(strip_whitespace=True, max_length=NAME)]


class RunChange(Wire):
    """What people may say of a run; what is left out stays as it is."""

    name: Name | None = None
    tags: Tags = Field(default=[])
    note: Annotated[str, StringConstraints(max_length=10_000)] | None = None

    def said(self) -> dict[str, Any]:
        """By field; text without anything in it is none."""
        said = self.model_dump(exclude_unset=True)
        return {
            field: value if field == "tags" else value or None for field, value in said.items()
        }


class Extension(Wire):
    """How many generations more."""

    generations: int = Field(ge=1, le=1_000_000)


Digest = Annotated[str, StringConstraints(pattern="^[0-9a-f]{64}$")]

Range = tuple[float, float]


class Beginning(Wire):
    """The creatures that a fork begins from: one of these."""

    creatures: Annotated[list[Digest], Field(min_length=1, max_length=4096)] | None = None
    """By name, from anywhere."""
    cells: Annotated[list[int], Field(min_length=1, max_length=1 << 20)] | None = None
    """The elites of these cells."""
    region: Annotated[dict[str, Range], Field(min_length=1)] | None = None
    """The elites whose descriptors, by axis, lie within these ends."""
    archive: Literal[True] | None = None
    """All elites."""

    @model_validator(mode="after")
    def refuse_many(self) -> Self:
        given = [name for name, value in self.model_dump().items() if value is not None]
        if len(given) != 1:
            names = ", ".join(type(self).model_fields)
            raise ValueError(f"needs one of {names}; got {', '.join(given) or 'none'}")
        return self


class Fork(Wire):
    """What a new run takes of another, and what is different."""

    start: Beginning = Field(alias="from")
    generation: Annotated[int, Field(ge=0)] | None = None
    """Elites as they were after it; None: as they are."""
    spec: dict[str, Any] = Field(default={})
    """A merge patch (RFC 7396) over the other run's spec."""
    name: Name | None = None


class ForkedFrom(Wire):
    """Where a fork began."""

    run: UUID | None
    """None where that run is gone."""
    creatures: int
    """How many of its creatures."""


class RunRead(Wire):
    id: UUID
    experiment: str
    name: str | None
    tags: list[str]
    note: str | None
    status: Status
    requested_state: Literal["paused", "cancelled"] | None
    """What a person asked of a running run that its worker has not done yet."""
    waiting_reason: str | None
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
    owner: str | None
    """The name of the token it was made with."""
    sweep: UUID | None
    """The sweep that it was asked for with."""
    deleted_at: datetime | None
    """Since when it lies in the bin."""
    purge_at: datetime | None
    """When it goes for good."""
    forked_from: ForkedFrom | None


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


class LogEntryRead(Wire):
    """What happened to a run."""

    id: int
    at: datetime
    level: Literal["info", "warning", "error"]
    attempt: int
    """Before the first one it is 0."""
    text: str


class Log(Wire):
    entries: list[LogEntryRead]


class TagRead(Wire):
    tag: str
    runs: int
    """How many have it."""
