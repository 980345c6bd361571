"""What a run will need, before it is one."""

from ..core.schemas import Wire


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
    speed: MeasuredSpeed | None
    """What the seconds rest on."""
    queue: QueueAhead
    drawing: DrawingRead
