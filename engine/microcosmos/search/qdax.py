"""Exchange with QDax (Chalumeau et al., JMLR 25, 2024): repertoires, scoring and emitters.

QDax is imported where it is needed. Its descriptors and centroids are places from 0 to 1 on our
axes' own scales; its rows of a grid are in another order than ours.
"""

import importlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import prod
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray, PyTree

from ..genomes import Genotype, Vector
from ..neat import Counters
from .cells import Axis, Cells, Grid, places
from .emitters.elites import Newcomer, newcomers
from .emitters.emitter import NO_PARENT, OPERATORS, Children, Keys, Outcome
from .evaluation import Evaluation
from .insertion import Elites

KEPT = ("features", "generation", "slot")
"""Columns of elites that a repertoire holds as extra scores."""


def needed(module: str) -> Any:
    """A module of QDax's. Raises `ValueError` with the command to install it."""
    try:
        return importlib.import_module(f"qdax.{module}")
    except ImportError as error:
        raise ValueError(
            f'QDax is needed and not installed: pip install "microcosmos[qdax]" ({error})'
        ) from error


def scoring_function(evaluate: Callable[[Genotype], Evaluation], cells: Cells) -> Callable:
    """QDax's protocol around an evaluation of a batch: fitness, descriptors, extra scores.

    Genotypes are networks, or plain arrays of genes from −1 to 1. What diverged has fitness
    −inf, so that no repertoire takes it.
    """

    def score(genotypes: Any, key: Any = None) -> tuple[Array, Array, dict[str, Array]]:
        plain = isinstance(genotypes, jax.Array | np.ndarray)
        found = evaluate(Vector(jnp.asarray(genotypes)) if plain else genotypes)
        sound = (found.status == 0) & jnp.isfinite(found.fitness)
        fitness = jnp.where(sound, found.fitness, -jnp.inf)
        place = jnp.where(sound[:, None], places(found.features, cells.axes), 0.0)
        return fitness, place, {"features": found.features, "status": found.status}

    return score


def order(cells: Cells) -> Int[np.ndarray, "cell"]:
    """Our number of each of QDax's cells: its grids swap the first two descriptors."""
    shape = tuple(axis.bins for axis in cells.axes)
    if not isinstance(cells, Grid) or len(shape) < 2:
        return np.arange(cells.count)
    return np.arange(prod(shape)).reshape(shape).swapaxes(0, 1).ravel()


def to_repertoire(elites: Elites, cells: Cells) -> Any:
    """A `MapElitesRepertoire` of the same elites; see `from_repertoire` for the way back."""
    rows = order(cells)
    there, genotypes = elites.occupied[rows], elites.genotypes
    genes = genotypes.values if isinstance(genotypes, Vector) else genotypes
    place = places(elites.features, cells.axes)[rows]
    return needed("core.containers.mapelites_repertoire").MapElitesRepertoire(
        genotypes=jax.tree.map(lambda x: x[rows], genes),
        fitnesses=jnp.where(there, elites.fitness[rows], -jnp.inf)[:, None],
        descriptors=jnp.where(there[:, None], place, 0.0),
        centroids=jnp.asarray(cells.centres[rows]),
        extra_scores={name: getattr(elites, name)[rows] for name in KEPT},
        keys_extra_scores=KEPT,
    )


def from_repertoire(repertoire: Any, cells: Cells, features: int) -> Elites:
    """Our elites of a repertoire over the same cells.

    Where it holds no features of ours as extra scores, those that are descriptors are made
    from its descriptors and the others are NaN.
    """
    rows, genes, told = np.argsort(order(cells)), repertoire.genotypes, repertoire.extra_scores
    plain = isinstance(genes, jax.Array | np.ndarray)
    genotypes = jax.tree.map(lambda x: x[rows], Vector(jnp.asarray(genes)) if plain else genes)
    fitness = jnp.reshape(repertoire.fitnesses, -1)[rows]
    there, none = jnp.isfinite(fitness), jnp.zeros(cells.count, jnp.int32)
    known = told.get("features")
    if known is None:
        known = _features(repertoire.descriptors, cells.axes, features)
    return Elites(
        occupied=there,
        fitness=jnp.where(there, fitness, 0.0),
        features=jnp.where(there[:, None], known[rows], 0.0),
        generation=told["generation"][rows] if "generation" in told else none,
        slot=told["slot"][rows] if "slot" in told else none,
        genotypes=genotypes,
    )


def _features(
    place: Float[Array, "cell axis"], axes: tuple[Axis, ...], features: int
) -> Float[Array, "cell feature"]:
    found = jnp.full((len(place), features), jnp.nan, jnp.float32)
    for i, axis in enumerate(axes):
        low, high = axis.low, axis.high
        if axis.logarithmic:
            low, high = np.log10(low), np.log10(high)
        value = low + place[:, i] * (high - low)
        found = found.at[:, axis.feature].set(10**value if axis.logarithmic else value)
    return found


class Told(eqx.Module):
    """An emitter of QDax's, and what became of its last children until it is told."""

    emitter: PyTree[Array]
    genes: Float[Array, "slot gene"]
    fitness: Float[Array, "slot"]
    place: Float[Array, "slot axis"]
    sound: Bool[Array, "slot"]
    due: Bool[Array, ""]
    """Whether the last children were its own: the first ones are newcomers."""


@dataclass(frozen=True)
class QdaxEmitter:
    """Any emitter of QDax's that begins without creatures, over vectors.

    It is told in the next generation, when the archive is what QDax shows it. Genes are cut at
    −1 and 1. What diverged counts as worse than the rest, in the best elite's cell.
    """

    slots: int
    newcomer: Newcomer
    cells: Cells
    emitter: Any
    operator: str

    def init(self, *, key: PRNGKeyArray) -> Told:
        """As QDax begins, over an empty repertoire."""
        genes = jnp.zeros((self.slots, *jax.eval_shape(self._newcomer).values.shape))
        place = jnp.zeros((self.slots, len(self.cells.axes)))
        fitness = jnp.full(self.slots, -jnp.inf, genes.dtype)
        with jax.numpy_rank_promotion("allow"):
            empty = needed("core.containers.mapelites_repertoire").MapElitesRepertoire
            empty = empty.init_default(genes[0], jnp.asarray(self.cells.centres))
            state = self.emitter.init(_raw(key), empty, genes, fitness, place, {})
        none = jnp.zeros(self.slots, bool)
        state = jax.tree.map(jnp.asarray, state)
        return Told(state, genes, fitness, place, none, jnp.zeros((), bool))

    def emit(
        self,
        state: Told,
        archive: Elites,
        counters: Counters,
        generation: Int[Array, ""],
        *,
        keys: Keys,
    ) -> tuple[Children, Told, Counters]:
        """Newcomers while the archive is empty, then what the emitter makes."""
        with jax.numpy_rank_promotion("allow"):
            repertoire = to_repertoire(archive, self.cells)
            learnt = jax.lax.cond(
                state.due, lambda: self._learnt(state, repertoire), lambda: state.emitter
            )
            genes, _ = self.emitter.emit(repertoire, learnt, _raw(keys[0]))
        anyone = jnp.any(archive.occupied)
        fresh = newcomers(self.newcomer, keys)
        assert isinstance(fresh.genotypes, Vector)
        operator = OPERATORS.index(self.operator)
        children = Children(
            Vector(jnp.where(anyone, jnp.clip(genes, -1.0, 1.0), fresh.genotypes.values)),
            jnp.full((self.slots, 2), NO_PARENT, jnp.int32),
            jnp.where(anyone, operator, fresh.operator).astype(jnp.int32),
        )
        return children, replace(state, emitter=learnt, due=anyone), counters

    def tell(self, state: Told, outcome: Outcome) -> Told:
        """Kept until the next generation."""
        assert isinstance(outcome.genotypes, Vector)
        return replace(
            state,
            genes=outcome.genotypes.values,
            fitness=outcome.fitness,
            place=places(outcome.features, self.cells.axes),
            sound=outcome.sound & jnp.isfinite(outcome.fitness),
        )

    def _learnt(self, state: Told, repertoire: Any) -> PyTree[Array]:
        sound, best = state.sound, jnp.argmax(repertoire.fitnesses[:, 0])
        worst = jnp.min(jnp.where(sound, state.fitness, repertoire.fitnesses[best, 0])) - 1.0
        learnt = self.emitter.state_update(
            emitter_state=state.emitter,
            repertoire=repertoire,
            genotypes=state.genes,
            fitnesses=jnp.where(sound, state.fitness, worst),
            descriptors=jnp.where(sound[:, None], state.place, repertoire.centroids[best]),
            extra_scores={},
        )
        return jax.tree.map(lambda new, old: new.astype(old.dtype), learnt, state.emitter)

    def _newcomer(self) -> Any:
        return self.newcomer(key=jax.random.key(0))


def cma_me(
    slots: int, newcomer: Newcomer, cells: Cells, *, step: float, emitters: int
) -> QdaxEmitter:
    """CMA-ME's improvement emitters (Fontaine et al., GECCO 2020), which take turns."""
    genes = jax.eval_shape(lambda: newcomer(key=jax.random.key(0))).values.shape[-1]
    one = needed("core.emitters.cma_improvement_emitter").CMAImprovementEmitter(
        batch_size=slots,
        genotype_dim=genes,
        centroids=jnp.asarray(cells.centres[order(cells)]),
        sigma_g=step,
    )
    pool = needed("core.emitters.cma_pool_emitter").CMAPoolEmitter(emitters, one)
    return QdaxEmitter(slots, newcomer, cells, pool, "cma-me")


def _raw(key: PRNGKeyArray) -> Array:
    """A key as numbers, as QDax's states hold it."""
    return jax.random.key_data(key)
