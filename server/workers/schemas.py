"""Workers, the queue, and how the server is."""

from datetime import datetime
from typing import Literal
from uuid import UUID

from ..core.schemas import Wire
from ..runs.schemas import Status


class RunBrief(Wire):
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


class PluginRead(Wire):
    """Something of users' own that a worker has."""

    kind: Literal["fitness", "descriptor", "body", "gait", "encoding"]
    name: str
    title: str
    unit: str
    source: str
    """SHA-256 of its module's source."""


class UnloadedRead(Wire):
    """A module of users' own that a worker could not load."""

    module: str
    reason: str


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
    current_run: RunBrief | None
    """The run that it is at."""
    heartbeat_at: datetime
    plugins: list[PluginRead]
    unloaded: list[UnloadedRead]


class QueuedRun(RunBrief):
    waiting_reason: str
    """Why it waits, in words."""
    queued_at: datetime
    memory_bytes: int | None
    """What it needs, as far as can be said."""


class QueueRead(Wire):
    total: int
    """Among them those that a worker is about to begin."""
    items: list[QueuedRun]
    """The first ones, in the order in which they will be taken."""


class Health(Wire):
    status: Literal["ok"] = "ok"
    help: bool
    """The documentation is served at `/help/`."""


class Readiness(Wire):
    database: Literal["ok", "unreachable"]
    redis: Literal["ok", "unreachable"]
