"""Repertoires and scoring functions of QDax.

Its descriptors and centroids are from 0 to 1 on our axes' own scales; its rows of a grid are in
another order than ours.
"""

import importlib
from collections.abc import Callable
from math import prod
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from ...genomes import Genotype, Vector
from ..cells import Axis, Cells, Grid, places
from ..evaluation import Evaluation
from ..gradients import Slopes, unit
from ..insertion import Elites

EXTRA_SCORES = ("measures", "generation", "slot")
"""Columns of elites that a repertoire holds as extra scores."""


def require_qdax(module: str) -> Any:
    """Import a module of QDax. Raises `ValueError` with the command to install it."""
    try:
        return importlib.import_module(f"qdax.{module}")
    except ImportError as error:
        raise ValueError(
            f'QDax is needed and not installed: pip install "microcosmos[qdax]" ({error})'
        ) from error


def scoring_function(
    evaluate: Callable[[Genotype], Evaluation],
    cells: Cells,
    slopes: Callable[[Genotype], Slopes] | None = None,
) -> Callable:
    """Wrap an evaluation of a batch in QDax's protocol: fitness, descriptors, extra scores.

    Genotypes are networks, or plain arrays of genes from −1 to 1. Infeasible creatures have
    fitness −inf, so that no repertoire takes them. With `slopes` the extra scores hold unit
    slopes (creature, gene, output) of fitness and descriptors for CMA-MEGA, 0 if not finite. A
    descriptor's direction is the same on any of its scales.
    """

    def score(genotypes: Any, key: Any = None) -> tuple[Array, Array, dict[str, Array]]:
        plain = isinstance(genotypes, jax.Array | np.ndarray)
        genotypes = Vector(jnp.asarray(genotypes)) if plain else genotypes
        found = evaluate(genotypes)
        feasible = (found.status == 0) & jnp.isfinite(found.fitness)
        fitness = jnp.where(feasible, found.fitness, -jnp.inf)
        place = jnp.where(feasible[:, None], places(found.measures, cells.axes), 0.0)
        extra = {"measures": found.measures, "status": found.status}
        if slopes is not None:
            known = slopes(genotypes)
            rows = jnp.where(known.finite[:, None, None], unit(known.rows), 0.0)
            extra["normalized_grads"] = jnp.swapaxes(rows, 1, 2)
        return fitness, place, extra

    return score


def order(cells: Cells) -> Int[np.ndarray, "cell"]:
    """Return our number of each of QDax's cells: its grids swap the first two descriptors."""
    shape = tuple(axis.bins for axis in cells.axes)
    if not isinstance(cells, Grid) or len(shape) < 2:
        return np.arange(cells.count)
    return np.arange(prod(shape)).reshape(shape).swapaxes(0, 1).ravel()


def to_repertoire(elites: Elites, cells: Cells) -> Any:
    """Return a `MapElitesRepertoire` of the same elites; `from_repertoire` is the inverse."""
    rows = order(cells)
    there, genotypes = elites.occupied[rows], elites.genotypes
    genes = genotypes.values if isinstance(genotypes, Vector) else genotypes
    place = places(elites.measures, cells.axes)[rows]
    return require_qdax("core.containers.mapelites_repertoire").MapElitesRepertoire(
        genotypes=jax.tree.map(lambda x: x[rows], genes),
        fitnesses=jnp.where(there, elites.fitness[rows], -jnp.inf)[:, None],
        descriptors=jnp.where(there[:, None], place, 0.0),
        centroids=jnp.asarray(cells.centres[rows]),
        extra_scores={name: getattr(elites, name)[rows] for name in EXTRA_SCORES},
        keys_extra_scores=EXTRA_SCORES,
    )


def from_repertoire(repertoire: Any, cells: Cells, measures: int) -> Elites:
    """Return our elites of a repertoire over the same cells.

    Without measures of ours among its extra scores, its descriptors give those measures and
    the others are NaN.
    """
    rows, genes, extra = np.argsort(order(cells)), repertoire.genotypes, repertoire.extra_scores
    plain = isinstance(genes, jax.Array | np.ndarray)
    genotypes = jax.tree.map(lambda x: x[rows], Vector(jnp.asarray(genes)) if plain else genes)
    fitness = jnp.reshape(repertoire.fitnesses, -1)[rows]
    there, none = jnp.isfinite(fitness), jnp.zeros(cells.count, jnp.int32)
    known = extra.get("measures")
    if known is None:
        known = _measures(repertoire.descriptors, cells.axes, measures)
    return Elites(
        occupied=there,
        fitness=jnp.where(there, fitness, 0.0),
        measures=jnp.where(there[:, None], known[rows], 0.0),
        generation=extra["generation"][rows] if "generation" in extra else none,
        slot=extra["slot"][rows] if "slot" in extra else none,
        curiosity=there.astype(jnp.float32),
        genotypes=genotypes,
    )


def _measures(
    place: Float[Array, "cell axis"], axes: tuple[Axis, ...], measures: int
) -> Float[Array, "cell measure"]:
    found = jnp.full((len(place), measures), jnp.nan, jnp.float32)
    for i, axis in enumerate(axes):
        low, high = axis.low, axis.high
        if axis.logarithmic:
            low, high = np.log10(low), np.log10(high)
        value = low + place[:, i] * (high - low)
        found = found.at[:, axis.measure].set(10**value if axis.logarithmic else value)
    return found
