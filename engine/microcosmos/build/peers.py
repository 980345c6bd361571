"""Scoring functions and repertoires of QDax from specs and archives."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .. import search, spec
from ..archive.file import load
from ..genomes import Genotype
from ..search import qdax
from .cells import build_cells
from .experiments import build_evolution, room_of
from .plugins import measures_of
from .scene import build_task


def scoring_function(chosen: spec.Evolution, *, slopes: bool = False) -> Callable:
    """Return a scoring function for QDax's `MAPElites`; see `search.qdax.scoring_function`.

    With `slopes` it suits QDax's `CMAMEGAEmitter`, for about seven times the work. Compiled
    within QDax's loop it rounds differently, so single creatures differ from those of our runs.
    """
    task = build_task(chosen.scene, room=room_of(chosen))
    descriptors = tuple(axis.name for axis in chosen.archive.descriptors)

    def evaluate(genotypes: Genotype) -> search.Evaluation:
        return search.mapped(lambda one: search.evaluate(task, one), genotypes)

    def derive(genotypes: Genotype) -> search.Slopes:
        return search.mapped(lambda one: search.slopes(task, one, descriptors), genotypes)

    cells = build_cells(chosen.archive, measures_of(chosen.scene))
    return qdax.scoring_function(evaluate, cells, derive if slopes else None)


def to_repertoire(archive: bytes | str | os.PathLike) -> Any:
    """Return the `MapElitesRepertoire` of an archive file, or of its bytes."""
    data = archive if isinstance(archive, bytes) else Path(archive).read_bytes()
    chosen = spec.parse(json.loads(load(data)[1]["spec"]))
    if not isinstance(chosen, spec.Evolution):
        raise ValueError(f"`archive` must be a search's, got {chosen.experiment}'s")
    state = build_evolution(chosen).restore(data, other_device=True)
    return qdax.to_repertoire(state.elites, state.cells)
