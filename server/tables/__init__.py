"""The tables. Rows are not wire types: those are in `schemas`."""

from .artifacts import (
    AUDIT,
    CHECKPOINT,
    EVALUATION,
    GIF,
    LOOP,
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
from .creatures import PENDING, Choice, Creature, GarbageCreature, InitialCreature, Parent
from .installation import InstallationState
from .operation import Notification, Total
from .results import CORRECTED, Elite, Generation, Result
from .runs import (
    CANCELLED,
    FAILED,
    FINISHED,
    HIGH,
    LOW,
    NORMAL,
    PAUSED,
    PRIORITIES,
    PROGRESS,
    QUEUED,
    RUNNING,
    STATUS_PLACE,
    STATUSES,
    TERMINAL,
    URGENT,
    Idempotency,
    LogEntry,
    Priority,
    Run,
    Status,
    Sweep,
)
from .shares import Share
from .tokens import NOBODY, USE_DAYS, DeviceUse, Token
from .workers import Plugin, ProblemKind, Worker
