"""The record of a run in a sink: its name, which stays the same when the run resumes."""

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..archive.beside import stem


@dataclass(frozen=True)
class Record:
    """A run as a sink knows it."""

    id: str
    """Equal for all attempts at one run; letters, digits, `-`, `_` and `.`."""
    name: str
    spec: dict[str, Any]
    generation: int = 0
    """The generation from which this attempt goes on."""

    def header(self) -> dict[str, Any]:
        return asdict(self)


def of_file(path: Path, spec: Mapping[str, Any], generation: int) -> Record:
    """Return the record of a run that `evolve` carries out into a file.

    It is the same as long as the path and the spec are, but for the number of generations.
    """
    kept: dict[str, Any] = json.loads(json.dumps(spec))
    kept.get("search", {}).pop("generations", None)
    text = json.dumps([str(path.resolve()), kept], sort_keys=True)
    name = stem(path)
    short = re.sub(r"[^A-Za-z0-9_.-]", "-", name)[:40]
    digest = hashlib.sha256(text.encode()).hexdigest()[:8]
    return Record(f"{short}-{digest}", name, dict(spec), generation)
