"""Use a server from Python: submit, watch, download. JAX is loaded only to compute."""

from .archive import Archive as Archive
from .client import Client as Client
from .columns import Columns as Columns
from .columns import Table as Table
from .creature import Creature as Creature
from .errors import Conflict as Conflict
from .errors import NoAnswer as NoAnswer
from .errors import NotAllowed as NotAllowed
from .errors import NotFound as NotFound
from .errors import NotMicrocosmos as NotMicrocosmos
from .errors import Refused as Refused
from .errors import ServerError as ServerError
from .replay import Replay as Replay
from .run import Run as Run
from .sharing import Share as Share
from .streaming import Event as Event
from .sweep import Summary as Summary
from .sweep import Sweep as Sweep
