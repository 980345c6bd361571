"""Specs and archives for QDax and pyribs."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import numpy as np

from .. import search, spec
from ..archive.file import load
from ..genomes import Genotype, Vector
from ..search import qdax, ribs
from .cells import build_cells
from .creatures import build_block
from .experiments import build_evolution, room_of
from .plugins import measures_of
from .scene import build_encoding, build_task


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


def ribs_function(
    chosen: spec.Evolution, *, worst: float = -1e6
) -> Callable[[Any], tuple[np.ndarray, np.ndarray]]:
    """Return a function of solutions for pyribs' schedulers; see `search.ribs.ribs_function`.

    Creatures are evaluated in blocks as in our own runs, so fitness has the same bits. With
    `search.feasible` infeasible creatures have the objective `worst`. Raises `ValueError` if
    the spec's genomes are networks.
    """
    if build_encoding(chosen.scene, room_of(chosen)).room is not None:
        raise ValueError(
            "`control.encoding` must be of numbers for pyribs, 'direct' or 'weights', got "
            f"{chosen.control.encoding!r}"
        )
    program, block = build_block(chosen.scene, room_of(chosen)), chosen.search.block

    def evaluate(genotypes: Vector) -> search.Evaluation:
        found = search.evaluate_blocks(program, jax.device_get(genotypes), block=block)
        return search.judged(found) if chosen.search.feasible else found

    cells = build_cells(chosen.archive, measures_of(chosen.scene))
    return ribs.ribs_function(evaluate, cells, worst)


def to_repertoire(archive: bytes | str | os.PathLike) -> Any:
    """Return the `MapElitesRepertoire` of an archive file, or of its bytes."""
    data = archive if isinstance(archive, bytes) else Path(archive).read_bytes()
    chosen = spec.parse(json.loads(load(data)[1]["spec"]))
    if not isinstance(chosen, spec.Evolution):
        raise ValueError(f"`archive` must be a search's, got {chosen.experiment}'s")
    state = build_evolution(chosen).restore(data, other_device=True)
    return qdax.to_repertoire(state.elites, state.container)
