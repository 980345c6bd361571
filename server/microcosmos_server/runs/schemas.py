"""Wire types of runs, forks, curves and logs."""

from datetime import datetime
from typing import Annotated, Any, Literal, Self
from uuid import UUID

from pydantic import AfterValidator, ConfigDict, Field, StringConstraints, model_validator

from microcosmos.spec.base import Digest

from ..core.schemas import Wire
from ..specs.schemas import PictureRead
from ..tables import NORMAL, Priority
from ..workers.schemas import RunBrief

NAME_LENGTH = 200


def distinct(tags: list[str]) -> list[str]:
    twice = next((tag for tag in tags if tags.count(tag) > 1), None)
    if twice is not None:
        raise ValueError(f"needs tags that differ; got {twice!r} more than once")
    return tags


Tag = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=50)]

Tags = Annotated[list[Tag], Field(max_length=20), AfterValidator(distinct)]


Name = Annotated[str, StringConstraints(strip_whitespace=True, max_length=NAME_LENGTH)]


Label = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9._=-]{0,62}$")]

Labels = Annotated[list[Label], Field(max_length=20), AfterValidator(distinct)]

YEAR = 366 * 86_400.0


class Scheduling(Wire):
    """The scheduling of a run; omitted fields stay as they are."""

    priority: Priority = NORMAL
    """`urgent` goes before the runs of all owners and needs a token of an admin; the others
    order the runs of one owner."""
    labels: Labels = Field(default=[])
    """Labels that its worker must have."""
    may_yield: bool = False
    """An urgent run may send this one back to the queue, with a checkpoint."""
    device_patience: Annotated[float, Field(ge=0.0, le=YEAR)] | None = None
    """Seconds to wait for the kind of device that has computed the run so far. Then another
    kind, whose results may differ in bits, continues it. None: wait for ever."""


class Submission(Scheduling):
    """The query of a request that submits a run."""

    name: Annotated[Name, StringConstraints(pattern=r"^[^\x00]*$")] | None = None


class RunChange(Scheduling):
    """New name, tags, note or scheduling of a run; omitted fields stay as they are."""

    name: Name | None = None
    tags: Tags = Field(default=[])
    note: Annotated[str, StringConstraints(max_length=10_000)] | None = None

    def values(self) -> dict[str, Any]:
        """Return the sent fields; empty texts become None."""
        sent = self.model_dump(exclude_unset=True)
        return {field: None if value == "" else value for field, value in sent.items()}


class Extension(Wire):
    """Generations to add."""

    generations: int = Field(ge=1, le=1_000_000)


Range = tuple[float, float]


class ForkStart(Wire):
    """The creatures that a fork starts from, given by one of these fields."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"minProperties": 1})

    creatures: Annotated[list[Digest], Field(min_length=1, max_length=4096)] | None = None
    """Creatures by name, from any run."""
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
    """The initial creatures of a fork, and the changes of its spec."""

    start: ForkStart = Field(alias="from")
    generation: Annotated[int, Field(ge=0)] | None = None
    """Take the elites as of this generation; None: as they are now."""
    spec: dict[str, Any] = Field(default={})
    """A merge patch (RFC 7396) for the other run's spec."""
    name: Name | None = None


class ForkedFrom(Wire):
    """The origin of a fork."""

    run: UUID | None
    """The other run; None if it is deleted."""
    creatures: int
    """Number of creatures taken from it."""


class RunRead(RunBrief):
    tags: list[str]
    note: str | None
    requested_state: Literal["paused", "cancelled", "queued"] | None
    """A requested state that the worker has not reached yet; `queued`: it yields to an urgent
    run."""
    priority: Priority
    labels: list[str]
    may_yield: bool
    device_patience: float | None
    waiting_reason: str | None
    """The reason why the run waits; None unless it is queued."""
    spec: dict[str, Any]
    created_at: datetime
    queued_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    eta_seconds: float | None
    evaluations: int
    evaluations_per_second: float | None
    qd_score: float | None
    coverage: float | None
    best: float | None
    face: str | None
    """The best creature that ever was an elite of the run, or that of its newest result; None
    before the first."""
    corrected_qd_score: float | None
    """QD score after the last reevaluation of the elites; None without one."""
    corrected_coverage: float | None
    hit_rate: float | None
    """Share of reevaluations in the elite's own cell."""
    summary: dict[str, Any] | None
    infeasible: int
    sparkline: list[float]
    """QD scores, evenly spaced over the generations so far."""
    error: str | None
    """The cause of a failed run, in a sentence; None for other runs."""
    error_details: str | None
    """The traceback, or the last lines that the process wrote."""
    warning: str | None
    device: str | None
    sinks: list[str] | None
    """Sinks that also get its curves and files (`tensorboard:FOLDER`); null until it starts."""
    version: str
    owner: str | None
    """Name of the token that created it."""
    sweep: UUID | None
    deleted_at: datetime | None
    purge_at: datetime | None
    """When it is deleted for good."""
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
    infeasible: list[int]
    seconds: list[float]
    summary: dict[str, list[float | None]]
    """Other recorded numbers by name: the newest since the previous point, else None."""


class Species(Wire):
    """Columns, one entry for each generation with recorded species."""

    generation: list[int]
    number: list[list[int]]
    """Numbers of the species, unique within a run."""
    members: list[list[int]]


class Target(PictureRead):
    """A picture that a filament folds into, scaled to its world."""

    size: int
    """Cells of its longer side; its centre is that of the world."""


class LogEntryRead(Wire):
    """An event in the history of a run."""

    id: int
    at: datetime
    level: Literal["info", "warning", "error"]
    attempt: int
    """0 before the first attempt."""
    text: str
    details: str | None
    """The traceback, or the last lines of a process, behind an error."""


class Log(Wire):
    entries: list[LogEntryRead]


class TagRead(Wire):
    tag: str
    runs: int
