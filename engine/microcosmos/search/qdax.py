"""Exchange with QDax (Chalumeau et al., JMLR 25, 2024): repertoires, scoring and emitters.

QDax's descriptors and centroids are from 0 to 1 on our axes' own scales; its rows of a grid are
in another order than ours. It is imported where it is needed.
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
import scipy
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray, PyTree

from ..bounds import refuse_uncountable
from ..genomes import CPPN, Genotype, Vector
from ..invalid import InvalidField
from ..neat import Counters, number
from .cells import Axis, Cells, Grid, places
from .emitters.emitter import (
    Children,
    Keys,
    Newcomer,
    Outcome,
    Problem,
    newcomers,
    or_newcomers,
    parentless,
)
from .emitters.variation import Neat
from .evaluation import Evaluation
from .gradients import Slopes, unit
from .insertion import Elites

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
        evaluation = evaluate(genotypes)
        feasible = (evaluation.status == 0) & jnp.isfinite(evaluation.fitness)
        fitness = jnp.where(feasible, evaluation.fitness, -jnp.inf)
        place = jnp.where(feasible[:, None], places(evaluation.measures, cells.axes), 0.0)
        extra = {"measures": evaluation.measures, "status": evaluation.status}
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
    occupied, genotypes = elites.occupied[rows], elites.genotypes
    genes = genotypes.values if isinstance(genotypes, Vector) else genotypes
    place = places(elites.measures, cells.axes)[rows]
    return require_qdax("core.containers.mapelites_repertoire").MapElitesRepertoire(
        genotypes=jax.tree.map(lambda x: x[rows], genes),
        # QDax tells an empty cell by this fitness alone; its genotype may be anything.
        fitnesses=jnp.where(occupied, elites.fitness[rows], -jnp.inf)[:, None],
        descriptors=jnp.where(occupied[:, None], place, 0.0),
        centroids=jnp.asarray(cells.centres[rows]),
        extra_scores={name: getattr(elites, name)[rows] for name in EXTRA_SCORES},
        keys_extra_scores=EXTRA_SCORES,
    )


def from_repertoire(repertoire: Any, cells: Cells, measures: int) -> Elites:
    """Return our elites of a repertoire over the same cells.

    Without measures of ours among its extra scores, its descriptors give those measures and
    the others are NaN. Raises `InvalidField` for a repertoire with other centroids, with
    several objectives, or with elites that are in another cell or are none of ours.
    """
    refuse_uncountable(1 + max(axis.measure for axis in cells.axes), measures=measures)
    _refuse_other_cells(repertoire, cells)
    rows, genes, extra = np.argsort(order(cells)), repertoire.genotypes, repertoire.extra_scores
    plain = isinstance(genes, jax.Array | np.ndarray)
    genotypes = Vector(jnp.asarray(genes)) if plain else genes
    _refuse_other_elites(repertoire, genotypes, cells, measures)
    genotypes = jax.tree.map(lambda x: x[rows], genotypes)
    fitness = jnp.reshape(repertoire.fitnesses, -1)[rows]
    occupied, none = jnp.isfinite(fitness), jnp.zeros(cells.count, jnp.int32)
    known = extra.get("measures")
    if known is None:
        known = _measures(repertoire.descriptors, cells.axes, measures)
    return Elites(
        occupied=occupied,
        fitness=jnp.where(occupied, fitness, 0.0),
        measures=jnp.where(occupied[:, None], known[rows], 0.0),
        generation=extra["generation"][rows] if "generation" in extra else none,
        slot=extra["slot"][rows] if "slot" in extra else none,
        curiosity=occupied.astype(jnp.float32),
        genotypes=genotypes,
    )


def _refuse_other_cells(repertoire: Any, cells: Cells) -> None:
    ours, theirs = cells.centres[order(cells)], np.asarray(repertoire.centroids)
    if np.size(repertoire.fitnesses) != cells.count:
        got = np.shape(repertoire.fitnesses)
        raise InvalidField(
            "repertoire", f"must have one fitness in each of {cells.count} cells; got {got}"
        )
    if theirs.shape != ours.shape or not np.allclose(theirs, ours, rtol=0, atol=1e-6):
        raise InvalidField(
            "repertoire", f"must have the centroids of `cells`, {ours.shape}; got others"
        )


def _refuse_other_elites(
    repertoire: Any, genotypes: Genotype, cells: Cells, measures: int
) -> None:
    """Raise `InvalidField` for arrays of another shape, and elites that none of ours can be."""
    extra, count = repertoire.extra_scores, cells.count
    shapes = {
        "descriptors": (count, len(cells.axes)),
        "extra_scores.measures": (count, measures),
    }
    shapes |= {"extra_scores.generation": (count,), "extra_scores.slot": (count,)}
    given = {f"extra_scores.{name}": extra[name] for name in EXTRA_SCORES if name in extra}
    given["descriptors"] = repertoire.descriptors
    for name, one in given.items():
        if np.shape(one) != shapes[name]:
            raise InvalidField(name, f"must have shape {shapes[name]}; got {np.shape(one)}")
    lengths = [np.shape(leaf)[:1] for leaf in jax.tree.leaves(genotypes)]
    if set(lengths) != {(count,)} or (isinstance(genotypes, Vector) and _axes(genotypes) != 2):
        got = [np.shape(leaf) for leaf in jax.tree.leaves(genotypes)]
        raise InvalidField("genotypes", f"must have {count} rows; got shapes {got}")
    fitness = np.reshape(repertoire.fitnesses, -1)
    occupied = fitness != -np.inf
    _refuse(
        "fitnesses", "must be finite, or −inf in an empty cell", ~np.isfinite(fitness[occupied])
    )
    for leaf in jax.tree.leaves(genotypes):
        genes = np.asarray(leaf)[occupied].reshape(np.count_nonzero(occupied), -1)
        # Our emitters vary vectors within these bounds.
        most = 1.0 if isinstance(genotypes, Vector) else np.finfo(np.float32).max
        able = np.all(np.abs(genes) <= most, 1) if genes.dtype.kind == "f" else True
        _refuse("genotypes", f"must be from {-most:g} to {most:g}", ~np.asarray(able))
    places_of = {"descriptors": np.asarray(repertoire.descriptors)}
    if "measures" in extra:
        known = jnp.asarray(extra["measures"])
        places_of["extra_scores.measures"] = np.asarray(places(known, cells.axes))
    homes = cells.centres[order(cells)]
    for name, place in places_of.items():
        place, home = place[occupied], homes[occupied]
        finite = np.all(np.isfinite(place), 1)
        _refuse(name, "must be finite where there is an elite", ~finite)
        # A value on the border of two cells may round into either.
        nearest = scipy.spatial.KDTree(homes).query(place)[0] + 1e-5
        away = np.sqrt(np.sum((place - home) ** 2, 1)) > nearest
        _refuse(name, "must be nearest to the centroid of their own cell", away)


def _axes(genotypes: Vector) -> int:
    return np.ndim(genotypes.values)


def _refuse(name: str, needed: str, wrong: np.ndarray) -> None:
    if np.any(wrong):
        raise InvalidField(name, f"{needed}; got {np.count_nonzero(wrong)} others")


def _measures(
    place: Float[Array, "cell axis"], axes: tuple[Axis, ...], measures: int
) -> Float[Array, "cell measure"]:
    columns = jnp.full((len(place), measures), jnp.nan, jnp.float32)
    for i, axis in enumerate(axes):
        low, high = axis.low, axis.high
        if axis.logarithmic:
            low, high = np.log10(low), np.log10(high)
        value = low + place[:, i] * (high - low)
        columns = columns.at[:, axis.measure].set(10**value if axis.logarithmic else value)
    return columns


class Pending(eqx.Module):
    """The state of a QDax emitter, and the outcome of its last children to learn next."""

    emitter: PyTree[Array]
    genes: Float[Array, "slot gene"]
    fitness: Float[Array, "slot"]
    place: Float[Array, "slot axis"]
    sound: Bool[Array, "slot"]
    due: Bool[Array, ""]
    """True if the emitter made the last children; the first ones are newcomers."""


@dataclass(frozen=True)
class QdaxEmitter:
    """Any emitter of QDax's over vectors that needs no creatures to begin.

    It learns an outcome in the next generation, with the archive that QDax would show it. Genes
    are cut at −1 and 1. Infeasible creatures count as worst, in the best elite's cell.
    """

    slots: int
    newcomer: Newcomer
    cells: Cells
    emitter: Any
    operator: str

    def init(self, *, key: PRNGKeyArray) -> Pending:
        genes = jnp.zeros(
            (self.slots, *jax.eval_shape(lambda: self.newcomer(key=key)).values.shape)
        )
        place = jnp.zeros((self.slots, len(self.cells.axes)))
        fitness = jnp.full(self.slots, -jnp.inf, genes.dtype)
        with jax.numpy_rank_promotion("allow"):
            empty = require_qdax("core.containers.mapelites_repertoire").MapElitesRepertoire
            empty = empty.init_default(genes[0], jnp.asarray(self.cells.centres))
            state = self.emitter.init(
                jax.random.key_data(key), empty, genes, fitness, place, {}
            )
        none = jnp.zeros(self.slots, bool)
        state = jax.tree.map(jnp.asarray, state)
        return Pending(state, genes, fitness, place, none, jnp.zeros((), bool))

    def emit(
        self, state: Pending, archive: Elites, *, keys: Keys
    ) -> tuple[Children, Pending, None]:
        # QDax broadcasts silently, which our tests make an error.
        with jax.numpy_rank_promotion("allow"):
            repertoire = to_repertoire(archive, self.cells)
            learnt = jax.lax.cond(
                state.due, lambda: self._learnt(state, repertoire), lambda: state.emitter
            )
            genes, _ = self.emitter.emit(repertoire, learnt, jax.random.key_data(keys[0]))
        bred = parentless(Vector(jnp.clip(genes, -1.0, 1.0)), self.slots, self.operator)
        children = or_newcomers(archive, bred, newcomers(self.newcomer, keys))
        due = jnp.any(archive.occupied)
        return children, replace(state, emitter=learnt, due=due), None

    def tell(self, state: Pending, outcome: Outcome) -> Pending:
        assert isinstance(outcome.genotypes, Vector)
        return replace(
            state,
            genes=outcome.genotypes.values,
            fitness=outcome.fitness,
            place=places(outcome.measures, self.cells.axes),
            sound=outcome.feasible & jnp.isfinite(outcome.fitness),
        )

    def _learnt(self, state: Pending, repertoire: Any) -> PyTree[Array]:
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


def build_cma_me(settings: Any, problem: Problem) -> QdaxEmitter:
    """Build CMA-ME's improvement emitters (Fontaine et al., GECCO 2020), which take turns."""
    newcomer, cells = problem.newcomer, problem.cells
    genes = jax.eval_shape(lambda: newcomer(key=jax.random.key(0))).values.shape[-1]
    one = require_qdax("core.emitters.cma_improvement_emitter").CMAImprovementEmitter(
        batch_size=problem.slots,
        genotype_dim=genes,
        centroids=jnp.asarray(cells.centres[order(cells)]),
        sigma_g=settings.step,
    )
    many = require_qdax("core.emitters.cma_pool_emitter").CMAPoolEmitter(settings.emitters, one)
    return QdaxEmitter(problem.slots, newcomer, cells, many, "cma-me")


@dataclass(frozen=True)
class NeatEmitter:
    """NEAT's mutations and crossover for QDax's `MAPElites`, whose genotypes are then networks.

    Its state counts the next unused gene numbers: equal mutations in a batch get equal
    numbers. Among several emitters of a `MultiEmitter` each sees all children.
    """

    emitter: Neat

    @property
    def batch_size(self) -> int:
        return self.emitter.slots

    @property
    def use_all_data(self) -> bool:
        return True  # Genes that others numbered are not numbered again.

    def init(
        self,
        key: Array,
        repertoire: Any,
        genotypes: CPPN,
        fitnesses: Array,
        descriptors: Array,
        extra_scores: dict[str, Array],
    ) -> Counters:
        return _beyond(genotypes, Counters(*(jnp.asarray(0),) * 3))

    def emit(
        self, repertoire: Any, emitter_state: Counters, key: Array
    ) -> tuple[CPPN, dict[str, Array]]:
        fitness = jnp.reshape(repertoire.fitnesses, -1)
        nothing = jnp.zeros(fitness.shape, jnp.int32)
        archive = Elites(
            occupied=jnp.isfinite(fitness),
            fitness=fitness,
            measures=repertoire.descriptors,
            generation=nothing,
            slot=nothing,
            curiosity=jnp.isfinite(fitness).astype(jnp.float32),
            genotypes=repertoire.genotypes,
        )
        # QDax passes raw keys, ours have a type.
        if not jnp.issubdtype(key.dtype, jax.dtypes.prng_key):
            key = jax.random.wrap_key_data(key)
        keys = jax.random.split(key, self.batch_size)
        children, _, novelty = self.emitter.emit(None, archive, keys=keys)
        assert isinstance(children.genotypes, CPPN)
        numbered, _ = number(children.genotypes, novelty, emitter_state)
        assert isinstance(numbered, CPPN)
        return numbered, {}

    def state_update(
        self,
        emitter_state: Counters,
        repertoire: Any,
        genotypes: CPPN,
        fitnesses: Array,
        descriptors: Array,
        extra_scores: dict[str, Array],
    ) -> Counters:
        return _beyond(genotypes, emitter_state)


def _beyond(networks: CPPN, counters: Counters) -> Counters:
    """Return the first numbers after those of the networks and the given ones."""
    used = jnp.where(networks.connection_used, networks.innovation, -1)
    nodes = jnp.where(networks.node_used, networks.node_id, -1)
    return replace(
        counters,
        innovation=jnp.maximum(counters.innovation, jnp.max(used) + 1),
        node=jnp.maximum(counters.node, jnp.max(nodes) + 1),
    )
