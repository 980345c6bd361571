"""Our specs and archives for QDax."""

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
    """What QDax's `MAPElites` takes; see `search.qdax.scoring_function`.

    With `slopes` it is what QDax's `CMAMEGAEmitter` takes, for about seven times the work.

    It may be compiled with QDax's loop. Rounding then depends on that program, and simulations
    are chaotic: figures of single creatures are not those of our own runs bit for bit.
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
    """The `MapElitesRepertoire` in an archive file, or in its bytes."""
    data = archive if isinstance(archive, bytes) else Path(archive).read_bytes()
    chosen = spec.parse(json.loads(load(data)[1]["spec"]))
    if not isinstance(chosen, spec.Evolution):
        raise ValueError(f"`archive` must be a search's, got {chosen.experiment}'s")
    state = build_evolution(chosen).restore(data, other_device=True)
    return qdax.to_repertoire(state.elites, state.cells)
