"""Use a server from Python: submit, watch, download. JAX is loaded only to compute."""

from .archive import Archive
from .client import Client
from .columns import Columns, Table
from .creature import Creature
from .errors import (
    Conflict,
    NoAnswer,
    NotAllowed,
    NotFound,
    NotMicrocosmos,
    Refused,
    ServerError,
)
from .polling import Event
from .replay import Replay
from .run import Run
from .sharing import Share
from .sweep import Summary, Sweep
