"""Wire types of estimates and of the queue."""

from datetime import datetime

from ..core.schemas import Wire
from ..specs.schemas import DrawingRead
from ..tables import Priority
from ..workers.schemas import RunBrief


class MeasuredSpeed(Wire):
    """Speed of earlier runs of the same kind on a device of a live worker."""

    device: str
    runs: int
    cell_steps_per_second: float
    low: float
    """Seconds at the speed of the fastest of those runs."""
    high: float
    """Seconds at the speed of the slowest."""


class QueueAhead(Wire):
    runs_ahead: int
    """Queued runs that go first, without those that workers are about to start."""
    workers: int
    idle_workers: int


class EstimateRead(Wire):
    memory_bytes: int
    memory_limit_bytes: int
    evaluations: int
    cell_steps: int
    seconds: float | None
    """None if no such run was measured on a device of a live worker."""
    speed: MeasuredSpeed | None
    """The measured speed behind `seconds`."""
    queue: QueueAhead
    drawing: DrawingRead


class QueuedRun(RunBrief):
    waiting_reason: str
    queued_at: datetime
    memory_bytes: int | None
    """Needed memory; None if it is unknown."""
    priority: Priority
    owner: str | None
    """Name of the token that created it."""


class QueueRead(Wire):
    total: int
    """All queued runs, also those that a worker is about to start."""
    warning: str | None
    """About a disk of the installation that is almost full."""
    items: list[QueuedRun]
    """The first ones, in the order in which workers take them."""
