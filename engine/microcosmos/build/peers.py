"""Our specs and archives for QDax."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .. import search, spec
from ..archive.file import load
from ..search import qdax
from .experiments import build_evolution, room_of
from .niches import build_niches
from .scene import build_task


def scoring_function(chosen: spec.Evolution) -> Callable:
    """What QDax's `MAPElites` takes; see `search.qdax.scoring_function`.

    It may be compiled with QDax's loop. Rounding then depends on that program, and simulations
    are chaotic: figures of single creatures are not those of our own runs bit for bit.
    """
    task = build_task(chosen.scene, room=room_of(chosen))
    return qdax.scoring_function(
        lambda genotypes: search.mapped(lambda one: search.evaluate(task, one), genotypes),
        build_niches(chosen.archive),
    )


def to_repertoire(archive: bytes | str | os.PathLike) -> Any:
    """The `MapElitesRepertoire` in an archive file, or in its bytes."""
    data = archive if isinstance(archive, bytes) else Path(archive).read_bytes()
    chosen = spec.parse(json.loads(load(data)[1]["spec"]))
    if not isinstance(chosen, spec.Evolution):
        raise ValueError(f"`archive` must be a search's, got {chosen.experiment}'s")
    state = build_evolution(chosen).restore(data, other_device=True)
    return qdax.to_repertoire(state.elites, state.niches)
