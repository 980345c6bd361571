"""Containers of elites: one elite in each cell, or survivors of a competition of all."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from operator import attrgetter

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ...genomes import Genotype
from ..cells import Axis, Cells, Grid, Voronoi
from ..insertion import Elites, Inserted, insert_into_cells
from .fronts import FrontFigures, Fronts, crowding_distance, front, front_figures, hypervolume
from .learned import LearnedAxes, learned_axes
from .survival import DominatedNovelty, Survival, dominated_novelty, insert_survivors

Container = Cells | Survival


def insert(
    archive: Elites, candidates: Elites, container: Container
) -> tuple[Elites, Inserted]:
    """Return the archive after the candidates of a generation, and the result for each.

    Ties are broken by a total order: fitness, then the smaller digest of the genome, then the
    earlier generation and slot. So the same candidates give the same archive on every device,
    in whatever order. Candidates that are not `occupied`, or whose fitness or descriptors are
    not finite, never enter.
    """
    if isinstance(container, Survival):
        return insert_survivors(archive, candidates, container)
    return insert_into_cells(archive, candidates, container)


def insert_program(
    options: Mapping[str, object] | None = None, *, donate: bool = False
) -> Callable[..., tuple[Elites, Inserted]]:
    """Compile `insert`, with these options of the compiler.

    With `donate` it overwrites the genotypes of the old archive, most of its bytes; they must
    not be used afterwards.
    """
    of = attrgetter("genotypes")

    def inserted(
        genotypes: Genotype, archive: Elites, candidates: Elites, container: Container
    ) -> tuple[Elites, Inserted]:
        whole = eqx.tree_at(of, archive, genotypes, is_leaf=lambda x: x is None)
        return insert(whole, candidates, container)

    # Genotypes are an argument of their own, since donation is by argument. Of 1,024 vectors of
    # 1,000 genes into 16,384 cells a donated insertion takes 1.1 ms (docs/evolution.md).
    program = jax.jit(
        inserted,
        donate_argnums=(0,) if donate else (),
        compiler_options=dict(options or {}),
    )

    def run(
        archive: Elites, candidates: Elites, container: Container
    ) -> tuple[Elites, Inserted]:
        rest = eqx.tree_at(of, archive, None)
        return program(archive.genotypes, rest, candidates, container)

    return run


def cells_of(container: Container) -> Cells:
    """Return the cells in which the figures of a container are taken."""
    return container.cells if isinstance(container, Survival) else container


def measured_axes(container: Container) -> tuple[Axis, ...]:
    """Return the axes of all measures that a container needs."""
    if isinstance(container, Fronts):
        return *container.axes, container.second
    return container.axes


def needed_columns(container: Container) -> tuple[int, ...]:
    """Return the columns of all measures that a container reads."""
    learned = container.columns if isinstance(container, LearnedAxes) else ()
    return *(axis.measure for axis in measured_axes(container)), *learned


def best_of_cells(elites: Elites, container: Container) -> Float[np.ndarray, "cell"]:
    """Return the best fitness in each cell in double precision, NaN in empty ones."""
    occupied, fitness = np.asarray(elites.occupied), np.asarray(elites.fitness, np.float64)
    if not isinstance(container, Survival):
        return np.where(occupied, fitness, np.nan)
    cell = np.asarray(container.cells.of(jnp.asarray(elites.measures)))
    best = np.full(container.cells.count, -np.inf)
    np.maximum.at(best, cell[occupied], fitness[occupied])
    return np.where(np.isfinite(best), best, np.nan)


def with_cells(container: Container, cells: Cells) -> Container:
    """Return the container with other cells."""
    return replace(container, cells=cells) if isinstance(container, Survival) else cells


def refreshed(
    container: Container, archive: Elites, candidates: Elites, generation: int
) -> Container:
    """Return the container for the insertion of a generation, counted from 1."""
    if isinstance(container, Survival):
        return container.refreshed(archive, candidates, generation)
    return container
