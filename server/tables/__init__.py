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
    GarbageFile,
)
from .base import Base, Expiring, Owned, Sha256
from .creatures import Creature, GarbageCreature, InitialCreature, Parent
from .results import CORRECTED, Elite, Generation, Result
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
    Idempotency,
    LogEntry,
    Run,
    Status,
    Sweep,
)
from .shares import Share
from .tokens import Token
from .workers import Plugin, Worker
