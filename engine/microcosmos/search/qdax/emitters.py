"""Emitters: QDax's in our loop, and our NEAT in QDax's."""

from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray, PyTree

from ...genomes import CPPN, Vector
from ...neat import Counters, number
from ..cells import Cells, places
from ..emitters.elites import Newcomer, newcomers, or_newcomers, parentless
from ..emitters.emitter import Children, Keys, Outcome
from ..emitters.neat import Neat
from ..insertion import Elites
from .repertoires import order, require_qdax, to_repertoire


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


def cma_me(
    slots: int, newcomer: Newcomer, cells: Cells, *, step: float, emitters: int
) -> QdaxEmitter:
    """Build CMA-ME's improvement emitters (Fontaine et al., GECCO 2020), which take turns."""
    genes = jax.eval_shape(lambda: newcomer(key=jax.random.key(0))).values.shape[-1]
    one = require_qdax("core.emitters.cma_improvement_emitter").CMAImprovementEmitter(
        batch_size=slots,
        genotype_dim=genes,
        centroids=jnp.asarray(cells.centres[order(cells)]),
        sigma_g=step,
    )
    pool = require_qdax("core.emitters.cma_pool_emitter").CMAPoolEmitter(emitters, one)
    return QdaxEmitter(slots, newcomer, cells, pool, "cma-me")


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
