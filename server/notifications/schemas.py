"""Wire types of what the webhook is sent."""

from datetime import datetime
from typing import Literal
from uuid import UUID

from ..core.schemas import Wire
from ..tables import Status


class RunNotice(Wire):
    """A run as it was when it ended or paused."""

    run: UUID
    name: str | None
    experiment: str
    status: Status
    generation: int
    generations: int
    """Number of generations at the end."""
    attempt: int
    sweep: UUID | None
    reason: str | None
    """Last line of the error of a failed run, or of the warning of a paused one."""
    url: str | None
    """Page of the run; null without `MICROCOSMOS_PUBLIC_URL`."""


class RunEvent(Wire):
    """What the webhook is sent when a run ends, fails or pauses until a person acts."""

    type: Literal["run.finished", "run.failed", "run.cancelled", "run.paused"]
    timestamp: datetime
    """When the run reached the state, by the clock of the database."""
    data: RunNotice
