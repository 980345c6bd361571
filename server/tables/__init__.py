"""The tables. Rows are not wire types: those are in `schemas`."""

from .artifacts import (
    AUDIT,
    CHECKPOINT,
    GIF,
    MEASUREMENT,
    MP4,
    PREVIEW,
    PUBLISHED,
    REPLAY,
    STRIP,
    Artifact,
)
from .base import Base, Owned, Sha256
from .creatures import Creature, Origin, Parent
from .garbage import Discarded, Leftover
from .idempotency import Idempotency
from .log import Entry
from .results import Elite, Generation, Result
from .runs import (
    CANCEL,
    CANCELLED,
    FAILED,
    FINISHED,
    GIVEN,
    NEEDED,
    PAUSE,
    PAUSED,
    QUEUED,
    RUNNING,
    STATUSES,
    TERMINAL,
    Run,
    Status,
)
from .shares import Share
from .sweeps import Sweep
from .tokens import Token
from .workers import Plugin, Worker

__all__ = [
    "AUDIT",
    "CANCEL",
    "CANCELLED",
    "CHECKPOINT",
    "FAILED",
    "FINISHED",
    "GIF",
    "GIVEN",
    "MEASUREMENT",
    "MP4",
    "NEEDED",
    "PAUSE",
    "PAUSED",
    "PREVIEW",
    "PUBLISHED",
    "QUEUED",
    "REPLAY",
    "RUNNING",
    "STATUSES",
    "STRIP",
    "TERMINAL",
    "Artifact",
    "Base",
    "Creature",
    "Discarded",
    "Elite",
    "Entry",
    "Generation",
    "Idempotency",
    "Leftover",
    "Origin",
    "Owned",
    "Parent",
    "Plugin",
    "Result",
    "Run",
    "Sha256",
    "Share",
    "Status",
    "Sweep",
    "Token",
    "Worker",
]
