"""A picture that a notebook shows."""

from pathlib import Path

from ..archive.atomic import write_whole


class Picture:
    """A PNG."""

    def __init__(self, data: bytes):
        self.data = data

    def _repr_png_(self) -> bytes:
        return self.data

    def __repr__(self) -> str:
        return f"<a picture of {len(self.data):,} bytes>"

    def save(self, path: str | Path) -> Path:
        write_whole(Path(path), self.data)
        return Path(path)
