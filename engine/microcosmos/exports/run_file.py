"""The file of a run, opened for an export: its arrays, spec and measures."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..archive.file import Tree, load
from ..spec import PluginVersion, plugins_in
from ..spec.measures import MEASURES
from ..spec.search import MEASURED


@dataclass(frozen=True)
class RunFile:
    """A run's file and the name by which its exports call it."""

    name: str
    data: bytes
    trees: Mapping[str, bytes] = field(default_factory=dict)
    """Its phylogeny across all runs of its server, as files by their ending."""

    @cached_property
    def _loaded(self) -> tuple[Tree, Tree]:
        return load(self.data)

    @property
    def tree(self) -> Tree:
        return self._loaded[0]

    @property
    def attributes(self) -> Tree:
        return self._loaded[1]

    @cached_property
    def spec(self) -> dict[str, Any]:
        return json.loads(self.attributes["spec"])

    @property
    def has_archive(self) -> bool:
        """Whether the run fills an archive; others have a table."""
        return "archive" in self.tree

    @property
    def generation(self) -> int:
        """The last generation that the file holds."""
        return int(self.tree["loop"]["generation"])

    @property
    def measures(self) -> list[str]:
        return json.loads(self.attributes["measures"])

    @cached_property
    def sha256(self) -> str:
        return hashlib.sha256(self.data).hexdigest()

    @cached_property
    def plugins(self) -> dict[str, PluginVersion]:
        return {one.name: one.version for one in plugins_in(self.spec)}

    def archive(self) -> Tree:
        """Return the archive; raise `ValueError` for a run without one."""
        if not self.has_archive:
            raise ValueError(
                f"{self.name} needs an archive for this format, as searches have; got the "
                f"table of {self.spec['experiment']!r}, which parquet and arrow can hold"
            )
        return self.tree["archive"]

    def facts(self) -> dict[str, Any]:
        """Return what identifies the run: spec, version, devices, generation, hash."""
        return {
            "spec": self.spec,
            "version": self.attributes["version"],
            "device": json.loads(self.attributes["device"]),
            "generation": self.generation,
            "sha256": self.sha256,
        }


def described(name: str, plugins: Mapping[str, PluginVersion]) -> tuple[str, str]:
    """Return the title and the unit of a measure; a unit of `1` is none."""
    known = plugins.get(name) or MEASURES.get(name)
    if known is None:
        return name.replace("_", " ").capitalize(), ""
    return known.title, known.unit or "1"


def fitness_of(task: Mapping[str, Any], plugins: Mapping[str, PluginVersion]) -> str:
    """Return the unit of fitness by a spec's task."""
    name = task["fitness"]
    return described(MEASURED.get(name, (name,))[0], plugins)[1]


def hexes(names: np.ndarray) -> list[str]:
    """Return SHA-256 (n, 32) of creatures as text."""
    return [bytes(row).hex() for row in names]
