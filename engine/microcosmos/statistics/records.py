"""Records of runs for statistics: spec, curves and state."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..archive.curves import CORRECTED
from ..archive.file import FORMAT, load, text_of
from ..spec import parse
from ..spec.paths import flattened

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
    """`finished`, or the generation that the run has reached."""

    @property
    def finished(self) -> bool:
        return self.state == "finished"

    @property
    def seed(self) -> int:
        return int(self.document["seed"])

    @property
    def evaluations(self) -> np.ndarray:
        """Return the number of simulations up to each generation."""
        return self.curves["evaluations"]

    @property
    def is_reevaluated(self) -> bool:
        """Return whether the search evaluates its elites again."""
        return bool(self.document["search"].get("reevaluation"))

    @cached_property
    def searched(self) -> np.ndarray:
        """Return the number of simulations up to each generation without those of elites again.

        These decide nothing, and there are more of them where there are more elites: if they
        counted, the better of two searches would be the shorter one.
        """
        if not self.is_reevaluated or CORRECTED[0] not in self.curves:
            return self.evaluations
        # Every generation searches as much as the first one.
        own = self.evaluations[0]
        if np.isfinite(self.curves[CORRECTED[0]][0]):
            own = self.document["search"]["batch"] + sum(self.spec.gradients)
        whole = np.arange(1, len(self.evaluations) + 1)
        # The server that compares runs reads some generations only.
        return own * np.asarray(self.curves.get("generation", whole))

    @cached_property
    def spec(self) -> Any:
        """Return the spec as an object. Raises `ValueError` for one that this version lacks."""
        return parse(self.document)

    @cached_property
    def fields(self) -> dict[str, Any]:
        """Return every value of the spec by its dotted path."""
        return dict(flattened(self.document))

    @cached_property
    def identity(self) -> str:
        """Return the SHA-256 of the spec and the curves, equal for copies of a run."""
        digest = hashlib.sha256(json.dumps(self.document, sort_keys=True).encode())
        for name in IDENTIFYING:
            digest.update(np.asarray(self.curves[name], np.float64).tobytes())
        return digest.hexdigest()


def read(data: bytes, name: str) -> RunRecord:
    """Return the run of an archive file. Raises `ValueError` for a run without an archive, and
    for one without a generation."""
    # Genomes and poses make up most of a file.
    try:
        tree, attributes = load(data, only=("curves",))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error
    document = json.loads(attributes["spec"])
    if "curves" not in tree:
        raise ValueError(
            f"{name}: a search is needed, whose file has curves; got {document['experiment']}"
        )
    done, wanted = len(tree["curves"]["evaluations"]), document["search"]["generations"]
    if not done:
        raise ValueError(f"{name}: a generation is needed, got a run that has none yet")
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
    runs = [run for one in sorted(path.glob("*.h5")) if (run := _search(one))]
    if not runs:
        raise ValueError(f"{path}: the folder needs archive files of searches (*.h5), got none")
    return runs


def _search(path: Path) -> RunRecord | None:
    """Return the run of a file in a folder, None where a sound file is of another kind.

    Creatures and other experiments are HDF5 too. Raises `ValueError` for a damaged file.
    """
    data = path.read_bytes()
    try:
        with h5py.File(BytesIO(data), "r") as file:
            ours = text_of(file.attrs.get("format")) == FORMAT and "curves" in file
    # Left out, it would make its group smaller unseen.
    except (OSError, RuntimeError, KeyError, TypeError) as error:
        raise ValueError(f"{path}: an archive file must be HDF5, undamaged: {error}") from error
    return read(data, str(path)) if ours else None
