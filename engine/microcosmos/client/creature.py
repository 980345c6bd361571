"""A creature on a server: its file, lineage, replay and pictures."""

import json
from functools import cached_property
from pathlib import Path
from typing import Any

import microcosmos

from ..archive.atomic import write_whole
from ..archive.poses import PoseStream, decode
from .connection import Connection
from .replay import Picture, Replay
from .sharing import Share, publish

ENDINGS = {
    ".json": "",
    ".h5": "/creature.h5",
    ".replay": "/replay",
    ".poses": "/poses",
    ".csv": "/poses.csv",
    ".png": "/strip.png",
    ".gif": "/film.gif",
    ".mp4": "/film.mp4",
    ".svg": "/network.svg",
    ".dot": "/network.dot",
    ".py": "/network.py",
    ".npz": "/network.npz",
}
"""Paths of the files of a creature, by the ending of a name."""


class Creature:
    """Immutable; its name is the SHA-256 of its identity."""

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
        """Return the creature file: identity, hash, measured numbers, provenance."""
        return self._connection.read(self._path)

    @property
    def identity(self) -> dict[str, Any]:
        return self.file["identity"]

    @property
    def measured(self) -> dict[str, Any] | None:
        """Return results of its evaluation: `fitness`, `descriptors`, `measures` …"""
        return self.file["measured"]

    @property
    def fitness(self) -> float | None:
        return self.measured["fitness"] if self.measured else None

    @property
    def trusted(self) -> bool | None:
        """Return the verdict of its audit on the server; None without an audit."""
        return self._connection.read(f"{self._path}/verdict")["trusted"]

    def replay(self, timeout: float = 300.0) -> Replay:
        """Return its recorded motion, which plays in a notebook; wait for the renderer."""
        return Replay(self._connection.rendering(f"{self._path}/replay", timeout))

    def poses(self, timeout: float = 300.0) -> PoseStream:
        """Return how its body moved over its last two strokes, without the fluid."""
        return decode(self._connection.rendering(f"{self._path}/poses", timeout))

    def preview(self, timeout: float = 300.0) -> Picture:
        """Return six moments of its motion side by side."""
        return Picture(self._connection.rendering(f"{self._path}/strip.png", timeout))

    def ancestors(self, depth: int = 3) -> dict[str, Any]:
        """Return parents, grandparents and so on, nearest first."""
        return self._connection.read(f"{self._path}/ancestors", depth=depth)

    def children(self, limit: int = 50) -> dict[str, Any]:
        """Return its offspring among the elites, the best first."""
        return self._connection.read(f"{self._path}/children", limit=limit)

    def check(self) -> Any:
        """Evaluate it again on this machine, bit for bit; see `microcosmos.check`."""
        return microcosmos.check(self.file)

    def share(self, **options: Any) -> Share:
        """Publish it under a link, with the options of `sharing.publish`."""
        return publish(self._connection, {"creature": self.sha}, **options)

    def save(self, path: str | Path, timeout: float = 300.0) -> Path:
        """Write the file that the ending names: `.json`, `.h5`, `.replay`, `.gif` …"""
        path = Path(path)
        ending = path.suffix.lower()
        if ending not in ENDINGS:
            known = ", ".join(ENDINGS)
            raise ValueError(f"`path` must end with one of {known}; got {path.name}")
        if ending == ".json":
            data = json.dumps(self.file, indent=1).encode()
        else:
            data = self._connection.rendering(self._path + ENDINGS[ending], timeout)
        write_whole(path, data)
        return path

    @property
    def _path(self) -> str:
        return f"creatures/{self.sha}"
