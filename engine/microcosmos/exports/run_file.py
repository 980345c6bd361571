"""The file of a run, opened for an export: its arrays, spec, measures and phylogeny."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..archive import export, measured
from ..archive.file import Tree, load, words
from ..archive.phylogeny import (
    NONE,
    Birth,
    Phylogeny,
    alife_csv,
    births_of,
    entries,
    newick,
    phylogeny,
)
from ..measures import MEASURES
from ..spec import PluginVersion, plugins_in
from ..spec.search import MEASURED


@dataclass(frozen=True)
class RunFile:
    """A run's file and the name by which its exports call it."""

    name: str
    data: bytes
    trees: Mapping[str, bytes] = field(default_factory=dict)
    """Files of the phylogeny across all runs of the server, by their endings."""
    ended: str | None = None
    """Time at which the run ended, in ISO 8601; None if it is unknown."""
    title: str = ""
    """Name that people gave the run on a server; empty if there is none."""

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
        """Return whether the run fills an archive; others have a table."""
        return "archive" in self.tree

    @property
    def generation(self) -> int:
        """Return the last generation in the file."""
        return int(self.tree["loop"]["generation"])

    @property
    def measures(self) -> dict[str, np.ndarray]:
        """Return a column for each measure of the elites."""
        return measured.columns(self.tree, self.attributes)

    @property
    def terms(self) -> dict[str, Any]:
        """Return the `licence` and `credit` of the file; empty without any."""
        return export.terms(self.attributes)

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
        """Return spec, version, devices, generation, hash, and the terms of the file."""
        return {
            "spec": self.spec,
            "version": self.attributes["version"],
            "device": json.loads(self.attributes["device"]),
            "generation": self.generation,
            "sha256": self.sha256,
            **self.terms,
        }


def described(name: str, plugins: Mapping[str, PluginVersion]) -> tuple[str, str]:
    """Return the title and the unit of a measure; a unit of `1` is none."""
    measure = measured.described(name, plugins)
    known = name in plugins or name in MEASURES
    return measure.title, measure.unit or ("1" if known else "")


def fitness_of(task: Mapping[str, Any], plugins: Mapping[str, PluginVersion]) -> str:
    """Return the unit of fitness by a spec's task."""
    name = task["fitness"]
    return described(MEASURED.get(name, (name,))[0], plugins)[1]


def hexes(names: np.ndarray) -> list[str]:
    """Return SHA-256 (n, 32) of creatures as text."""
    return [bytes(row).hex() for row in names]


def fittest(run: RunFile) -> set[str]:
    """Return the creatures of the largest fitness in a run's archive; none without elites."""
    fitness = run.archive()["fitness"]
    best = fitness == np.max(fitness, initial=-np.inf)
    return set(hexes(run.archive()["creature"][best]))


def of_file(run: RunFile) -> Phylogeny:
    """Return all creatures that ever entered a run's archive, below its initial creatures.

    Raises `ValueError` for a run without an archive. A creature is lost when another takes its
    cell. The file does not tell when a container gave up a creature: the last generation
    counts then.
    """
    present = set(hexes(run.archive()["creature"]))
    rows = run.tree["lineage"]
    creatures = hexes(rows["creature"])
    operators = words(rows["operator"], json.loads(run.attributes["operators"]))
    numbers = (rows[name].tolist() for name in ("cell", "generation"))
    columns = (*numbers, creatures, rows["fitness"].tolist(), operators)
    # By cell and generation: an entry ends where the next one takes its cell.
    entered = sorted(zip(*columns, strict=True), key=lambda row: row[:2])
    links: dict[str, list[str]] = {}
    for name, parents in zip(creatures, rows["parents"], strict=True):
        # A creature that entered again keeps the parents of its first entry.
        links.setdefault(name, [bytes(one).hex() for one in parents if one.any()])

    def held(creature: str) -> int | None:
        return None if creature in present else run.generation

    known = list(births_of(entries(run.name, entered, held), links))
    initial = hexes(run.tree["initial"]["creature"]) if "initial" in run.tree else []
    entered_names = {birth.creature for birth in known}
    # Initial creatures are roots unless they entered themselves
    # (test_initial_creatures_are_roots).
    first = [Birth(name, (), None, NONE, {}, None, None) for name in initial]
    first = [birth for birth in first if birth.creature not in entered_names]
    return phylogeny([*first, *known], [run.name], [(run.name, name) for name in initial])


FORMS = {"csv": alife_csv, "nwk": newick}
"""The ALife phylogeny standard and Newick, by the ending of their files."""


def written(run: RunFile, ending: str) -> bytes:
    """Return the phylogeny in a form: that of the run's server, or of its file alone."""
    if ending in run.trees:
        return run.trees[ending]
    return FORMS[ending](of_file(run)).encode()
