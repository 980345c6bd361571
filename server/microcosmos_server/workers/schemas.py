"""Wire types of workers and their runs."""

from datetime import datetime
from typing import Literal
from uuid import UUID

from microcosmos.plugins import Kind

from ..core.schemas import Wire
from ..tables import ProblemKind, Status


class RunBrief(Wire):
    """A run in short."""

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
    """A plug-in that a worker has."""

    kind: Kind
    name: str
    title: str
    unit: str
    source: str
    """SHA-256 of its module's source."""


class UnloadedRead(Wire):
    """A plug-in module that a worker could not load."""

    module: str
    reason: str


class GpuRead(Wire):
    """The state of a GPU; None where it does not tell."""

    uuid: str
    temperature_celsius: float | None
    ecc_errors: int | None
    """Memory errors of its lifetime that could not be corrected."""


class WorkerRead(Wire):
    name: str
    device: str
    kind: Literal["cpu", "gpu"]
    memory_bytes: int
    """Memory of the machine, or of the GPU."""
    memory_used_bytes: int | None
    load: float | None
    """Load of the machine over a minute per core, or of the GPU; 1 is fully busy."""
    status: Literal["idle", "busy"]
    since: datetime
    run: UUID | None
    current_run: RunBrief | None
    heartbeat_at: datetime
    plugins: list[PluginRead]
    unloaded: list[UnloadedRead]
    device_kinds: list[str]
    """Kinds of devices whose results it repeats bit for bit; none before its self-test."""
    labels: list[str]
    problem: str | None
    """The reason why the worker takes no run."""
    problem_kind: ProblemKind | None
    gpu: GpuRead | None
    """The state of the GPU; None for a worker on a processor."""
