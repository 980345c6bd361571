"""Runs as statistics need them: spec, curves, and whether they are complete."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..archive.file import HDF5, load
from ..spec import parse
from ..spec.differences import flattened

IDENTIFYING = ("evaluations", "qd_score", "coverage", "best")
"""Curves that tell two runs of one spec apart, as of two versions or with other choices."""


@dataclass(frozen=True, eq=False)
class RunRecord:
    """A search with its curves, which have one entry for each generation."""

    name: str
    """The path of its file, or its id on a server."""
    document: Mapping[str, Any]
    """The spec."""
    curves: Mapping[str, np.ndarray]
    version: str
    devices: tuple[str, ...]
    state: str
    """`finished`, or how far it is."""

    @property
    def finished(self) -> bool:
        return self.state == "finished"

    @property
    def seed(self) -> int:
        return int(self.document["seed"])

    @property
    def evaluations(self) -> np.ndarray:
        """Simulations of a creature up to each generation."""
        return self.curves["evaluations"]

    @cached_property
    def spec(self) -> Any:
        """The spec as an object. Raises `ValueError` for one that is unknown here."""
        return parse(self.document)

    @cached_property
    def fields(self) -> dict[str, Any]:
        """Every value of the spec by its dotted path."""
        return dict(flattened(self.document))

    @cached_property
    def identity(self) -> str:
        """SHA-256 of the spec and the curves: equal for copies of a run."""
        found = hashlib.sha256(json.dumps(self.document, sort_keys=True).encode())
        for name in IDENTIFYING:
            found.update(np.asarray(self.curves[name], np.float64).tobytes())
        return found.hexdigest()


def read(data: bytes, name: str) -> RunRecord:
    """Return the run of an archive file. Raises `ValueError` for a run without an archive."""
    tree, attributes = load(data, only=("curves",))
    document = json.loads(attributes["spec"])
    if "curves" not in tree:
        raise ValueError(
            f"{name}: a search is needed, whose file has curves; got {document['experiment']}"
        )
    done, wanted = len(tree["curves"]["evaluations"]), document["search"]["generations"]
    ended = json.loads(attributes["ended"])
    return RunRecord(
        name=name,
        document=document,
        curves=tree["curves"],
        version=attributes["version"],
        devices=tuple(json.loads(attributes["device"])),
        state="finished" if ended else f"at generation {done:,} of {wanted:,}",
    )


def read_files(paths: Iterable[Path]) -> list[RunRecord]:
    """Return the runs of archive files, and of all searches in folders, in order of names."""
    return [run for path in paths for run in _read_path(path)]


def _read_path(path: Path) -> list[RunRecord]:
    if not path.is_dir():
        return [read(path.read_bytes(), str(path))]
    files = [one for one in sorted(path.glob("*.h5")) if _is_search(one)]
    if not files:
        raise ValueError(f"{path}: the folder needs archive files of searches (*.h5), got none")
    return [read(one.read_bytes(), str(one)) for one in files]


def _is_search(path: Path) -> bool:
    """Return whether a file is of a search; creatures and other experiments are HDF5 too."""
    data = path.read_bytes()
    if not data.startswith(HDF5):
        return False
    try:
        return "curves" in load(data, only=("curves",))[0]
    except ValueError:
        return False
