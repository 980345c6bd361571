"""A creature on a server: what it is, what was measured, how it moves."""

import json
from functools import cached_property
from pathlib import Path
from typing import Any

import microcosmos

from ..archive.atomic import write_whole
from .connection import Connection
from .picture import Picture
from .replay import Replay
from .sharing import Share, publish
from .waiting import made

ENDINGS = {
    ".json": "",
    ".h5": "/creature.h5",
    ".replay": "/replay",
    ".png": "/strip.png",
    ".gif": "/film.gif",
    ".mp4": "/film.mp4",
    ".svg": "/network.svg",
    ".dot": "/network.dot",
    ".py": "/network.py",
    ".npz": "/network.npz",
}
"""What a creature can be saved as, and where that is."""


class Creature:
    """Immutable, named by the SHA-256 of what it is."""

    def __init__(self, connection: Connection, sha: str):
        self._connection, self.sha = connection, sha

    def __repr__(self) -> str:
        return f"<Creature {self.sha[:12]}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Creature) and other.sha == self.sha

    def __hash__(self) -> int:
        return hash(self.sha)

    @cached_property
    def file(self) -> dict[str, Any]:
        """The creature file: identity, hash, what was measured, where it came from."""
        return self._connection.read(self._path)

    @property
    def identity(self) -> dict[str, Any]:
        return self.file["identity"]

    @property
    def measured(self) -> dict[str, Any] | None:
        """What was found when it was evaluated: `fitness`, `descriptors`, `measures` …"""
        return self.file["measured"]

    @property
    def fitness(self) -> float | None:
        return self.measured["fitness"] if self.measured else None

    def replay(self, timeout: float = 300.0) -> Replay:
        """Its recorded motion, which plays in a notebook; waits while it is rendered."""
        return Replay(made(self._connection, f"{self._path}/replay", timeout).content)

    def preview(self, timeout: float = 300.0) -> Picture:
        """Six moments of its motion side by side."""
        return Picture(made(self._connection, f"{self._path}/strip.png", timeout).content)

    def ancestors(self, depth: int = 3) -> dict[str, Any]:
        """Parents and theirs, nearest first."""
        return self._connection.read(f"{self._path}/ancestors", depth=depth)

    def children(self, limit: int = 50) -> dict[str, Any]:
        """Elites that came from it, the best first."""
        return self._connection.read(f"{self._path}/children", limit=limit)

    def check(self) -> Any:
        """Evaluate it again on this machine, bit for bit; see `microcosmos.check`."""
        return microcosmos.check(self.file)

    def share(self, **said: Any) -> Share:
        """Publish it under a link; `title`, `credit`, `licence`, `days`, `listed`."""
        return publish(self._connection, {"creature": self.sha}, **said)

    def save(self, path: str | Path, timeout: float = 300.0) -> Path:
        """The creature file, or what the path's ending asks for, as `.gif` or `.replay`."""
        path = Path(path)
        if path.suffix not in ENDINGS:
            known = ", ".join(ENDINGS)
            raise ValueError(f"`path` must end with one of {known}; got {path.name}")
        if path.suffix == ".json":
            data = json.dumps(self.file, indent=1).encode()
        else:
            data = made(self._connection, self._path + ENDINGS[path.suffix], timeout).content
        write_whole(path, data)
        return path

    @property
    def _path(self) -> str:
        return f"creatures/{self.sha}"
