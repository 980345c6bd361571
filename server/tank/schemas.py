"""Wire types of the tank."""

from uuid import UUID

from ..core.schemas import Wire
from ..workers.schemas import RunBrief


class Swimmer(Wire):
    """A creature in the tank, from one of its runs."""

    creature: str
    run: UUID
    generation: int
    """In which it entered the archive."""
    fitness: float


class Tank(Wire):
    """The best and the most different creatures of the latest runs, each once."""

    swimmers: list[Swimmer]
    """In the order in which a smaller tank takes them."""
    runs: list[RunBrief]
    """The runs from which they come: running ones first, then the latest."""
