"""What a run will need, before it is one."""

from ..core.schemas import Wire
from ..specs.schemas import DrawingRead


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
