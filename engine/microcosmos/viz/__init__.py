"""Drawing: replays, films, figures for print, networks; `replay` and `figures` load JAX."""

from .film import gif, mp4
from .notebook import filmed, show
from .raster import frame
from .replay_file import Replay, ReplayError, read_replay
