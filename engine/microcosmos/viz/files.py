"""A replay as a file to look at, of the kind that its name says."""

from pathlib import Path
from typing import Any

from .film import gif, mp4
from .replay_file import read_replay
from .strip import strip

MAKERS = {".png": strip, ".gif": gif, ".mp4": mp4}


def export(data: bytes, path: str | Path, **options: Any) -> None:
    """Writes the bytes of a replay as .png (a strip of moments), .gif or .mp4.

    `options` are those of `strip`, `gif` or `mp4`.
    """
    path = Path(path)
    if path.suffix.lower() not in MAKERS:
        raise ValueError(f"`path` must end in {', '.join(MAKERS)}, got {str(path)!r}.")
    path.write_bytes(MAKERS[path.suffix.lower()](read_replay(data), **options))
