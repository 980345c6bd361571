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
from .creatures import Creature, InitialCreature, Parent
from .garbage import GarbageCreature, GarbageFile
from .idempotency import Idempotency
from .log import LogEntry
from .results import Elite, Generation, Result
from .runs import (
    CANCELLED,
    FAILED,
    FINISHED,
    OVERRIDE_ALLOWED,
    OVERRIDE_NEEDED,
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
    "CANCELLED",
    "CHECKPOINT",
    "FAILED",
    "FINISHED",
    "GIF",
    "MEASUREMENT",
    "MP4",
    "OVERRIDE_ALLOWED",
    "OVERRIDE_NEEDED",
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
    "Elite",
    "GarbageCreature",
    "GarbageFile",
    "Generation",
    "Idempotency",
    "InitialCreature",
    "LogEntry",
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
