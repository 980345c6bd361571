"""What a run will need, before it is one."""

from datetime import datetime

from ..core.schemas import Wire
from ..specs.schemas import DrawingRead
from ..workers.schemas import RunBrief


class MeasuredSpeed(Wire):
    """How fast earlier runs of the same kind were, on a device that there is."""

    device: str
    runs: int
    cell_steps_per_second: float
    low: float
    """Seconds at the speed of the fastest of those runs."""
    high: float
    """Seconds at the speed of the slowest."""


class QueueAhead(Wire):
    runs_ahead: int
    """Runs that go before it: those in the queue that no worker is about to begin."""
    workers: int
    idle_workers: int
    """Workers that have nothing to do."""


class EstimateRead(Wire):
    memory_bytes: int
    memory_limit_bytes: int
    evaluations: int
    cell_steps: int
    seconds: float | None
    """None where no run of the kind was measured on a device that there is."""
    speed: MeasuredSpeed | None
    """What the seconds rest on."""
    queue: QueueAhead
    drawing: DrawingRead


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
