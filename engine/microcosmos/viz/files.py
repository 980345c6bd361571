"""Export replays as PNG strips, GIF and MP4 films."""

from pathlib import Path
from typing import Any

from ..optional import require
from .film import gif, mp4
from .replay_file import read_replay
from .strip import strip

MAKERS = {".png": strip, ".gif": gif, ".mp4": mp4}
NEEDS = {".png": ("PIL.Image",), ".gif": ("PIL.Image",), ".mp4": ("PIL.Image", "av")}
"""Optional modules of each kind of file."""


def check(path: Path) -> None:
    """Raise where a file of this kind cannot be written, before anything is computed."""
    kind = path.suffix.lower()
    if kind not in MAKERS:
        raise ValueError(f"`path` must end in {', '.join(MAKERS)}, got {str(path)!r}.")
    for module in NEEDS[kind]:
        require(module)


def export(data: bytes, path: str | Path, **options: Any) -> None:
    """Write the bytes of a replay as .png (a strip of moments), .gif or .mp4.

    `options` are those of `strip`, `gif` or `mp4`.
    """
    path = Path(path)
    check(path)
    path.write_bytes(MAKERS[path.suffix.lower()](read_replay(data), **options))
