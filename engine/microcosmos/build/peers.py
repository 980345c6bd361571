"""Specs and archives for QDax and pyribs."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import search, spec
from ..archive.file import load
from ..genomes import Genotype, Vector
from ..invalid import InvalidField
from ..search import qdax
from ..search.cells import Cells
from .experiments import build_evolution, room_of
from .plan import build_cells
from .plugins import measures_of
from .scene import build_block, build_encoding, build_task


def scoring_function(chosen: spec.Evolution, *, slopes: bool = False) -> Callable:
    """Return a scoring function for QDax's `MAPElites`; see `search.qdax.scoring_function`.

    With `search.feasible` infeasible creatures have fitness −inf too. With `slopes` it suits
    QDax's `CMAMEGAEmitter`, for about seven times the work. Compiled within QDax's loop it
    rounds differently, so single creatures differ from those of our runs.
    """
    task = build_task(chosen.scene, room=room_of(chosen))
    descriptors = tuple(axis.name for axis in chosen.archive.descriptors)

    def evaluate(genotypes: Genotype) -> search.Evaluation:
        found = search.mapped(lambda one: search.evaluate(task, one), genotypes)
        return search.judged(found) if chosen.search.feasible else found

    def derive(genotypes: Genotype) -> search.Slopes:
        return search.mapped(lambda one: search.slopes(task, one, descriptors), genotypes)

    cells = build_cells(chosen.archive, measures_of(chosen.scene))
    return qdax.scoring_function(evaluate, cells, derive if slopes else None)


def ribs_function(
    chosen: spec.Evolution, *, worst: float = -1e6
) -> Callable[[Any], tuple[np.ndarray, np.ndarray]]:
    """Return a function for pyribs' schedulers (Tjanaka et al., GECCO 2023).

    It takes solutions and returns the objectives and measures of `tell`, in the same order.
    Measures are from 0 to 1 on the axes' own scales, and genes beyond ±1 count as ±1. Creatures
    are evaluated in blocks as in our own runs, so fitness has the same bits. Solutions that are
    not finite, and with `search.feasible` infeasible ones, have the objective `worst` and
    measures of 0. Raises `ValueError` if the spec's genomes are networks.
    """
    if build_encoding(chosen.scene, room_of(chosen)).room is not None:
        raise ValueError(
            "`control.encoding` must be of numbers for pyribs, as 'direct', got "
            f"{chosen.control.encoding!r}"
        )
    program, block = build_block(chosen.scene, room_of(chosen)), chosen.search.block

    axes = build_cells(chosen.archive, measures_of(chosen.scene)).axes

    def function(solutions: Any) -> tuple[np.ndarray, np.ndarray]:
        genes = np.clip(np.asarray(solutions, np.float32), -1.0, 1.0)
        rows = jax.device_get(Vector(jnp.asarray(genes)))
        results = search.evaluate_blocks(program, rows, block=block)
        return ribs_results(
            search.judged(results) if chosen.search.feasible else results, axes, worst
        )

    return function


def ribs_results(
    results: search.Evaluation, axes: tuple[search.Axis, ...], worst: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the objectives (solution,) and measures (solution, axis) of evaluations."""
    place = np.asarray(search.places(jnp.asarray(results.measures), axes))
    fitness, status = np.asarray(results.fitness), np.asarray(results.status)
    sound = (status == 0) & np.isfinite(fitness) & np.isfinite(place).all(1)
    # pyribs refuses a whole batch with a number that is not finite. An archive whose
    # `threshold_min` is not below `worst` refuses these solutions alone.
    objective = np.where(sound, fitness, np.float32(worst))
    return objective, np.where(sound[:, None], place, np.float32(0))


def to_repertoire(archive: bytes | str | os.PathLike) -> Any:
    """Return the `MapElitesRepertoire` of an archive file, or of its bytes.

    Raises `InvalidField` for an archive that keeps something else than an elite in each cell.
    """
    data = archive if isinstance(archive, bytes) else Path(archive).read_bytes()
    chosen = spec.parse(json.loads(load(data)[1]["spec"]))
    if not isinstance(chosen, spec.Evolution):
        raise ValueError(f"`archive` must be a search's, got {chosen.experiment}'s")
    state = build_evolution(chosen).restore(data, other_device=True)
    cells = state.container
    if not isinstance(cells, Cells):
        kind = type(cells).__name__
        needed = "must keep one elite in each cell for a repertoire"
        raise InvalidField("archive.container", f"{needed}; got {kind}")
    return qdax.to_repertoire(state.elites, cells)
