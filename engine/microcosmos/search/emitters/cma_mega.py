"""CMA-MEGA: an evolution strategy over steps along the slopes of fitness and descriptors.

Fontaine and Nikolaidis, NeurIPS 2021, algorithm 2: one solution θ moves; its children are θ
plus random combinations of the unit slopes there, drawn from a distribution that adapts to what
enters the archive. The distribution is the one of `matrix_adaptation`.
"""

from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from ...genomes import Genotype, Vector
from ...portable import product
from ..gradients import Slopes, unit
from ..insertion import Elites
from . import matrix_adaptation as es
from .elites import Newcomer, newcomers, or_newcomers, parentless
from .emitter import Children, Keys, Outcome
from .selection import draw


class CmaMegaState(eqx.Module):
    """The state of the emitter."""

    theta: Float[Array, "gene"]
    slopes: Float[Array, "output gene"]
    """Slopes at θ, of length 1."""
    distribution: es.Distribution
    """The distribution of weights on the slopes."""
    z: Float[Array, "slot output"]
    """The normal numbers behind the present weights."""
    weights: Float[Array, "slot output"]
    due: Bool[Array, ""]
    """True if the emitter made the present children; the first ones are newcomers."""
    restart: Bool[Array, ""]
    """True if the search restarts at an elite."""


@dataclass(frozen=True)
class CmaMega:
    """One θ whose children fill the emitter's slots; genes are cut at −1 and 1."""

    slots: int
    newcomer: Newcomer
    outputs: int
    """Number of slopes: fitness and descriptors."""
    step: float = 0.5
    """Initial standard deviation of the weights."""
    rate: float = 1.0
    """Step of θ towards its best children."""
    lessons: int = 1

    def init(self, *, key: PRNGKeyArray) -> CmaMegaState:
        theta = jnp.zeros_like(self.newcomer(key=key).values)
        none = jnp.zeros((self.slots, self.outputs), theta.dtype)
        return CmaMegaState(
            theta=theta,
            slopes=jnp.zeros((self.outputs, theta.shape[0]), theta.dtype),
            distribution=self._anew(theta),
            z=none,
            weights=none,
            due=jnp.zeros((), bool),
            restart=jnp.ones((), bool),
        )

    def emit(
        self, state: CmaMegaState, archive: Elites, *, keys: Keys
    ) -> tuple[Children, CmaMegaState, None]:
        """Return θ in each slot until slopes are known; newcomers into an empty archive."""
        chosen = draw(archive, key=jax.random.fold_in(keys[0], 1))
        genotypes = archive.genotypes
        assert isinstance(genotypes, Vector)
        theta = jnp.where(state.restart, genotypes.values[chosen], state.theta)
        distribution = es.restarted(state.restart, self._anew(theta), state.distribution)
        weights, z = es.draw(distribution, keys=keys)
        moved = Vector(jnp.broadcast_to(theta, (self.slots, *theta.shape)))
        children = or_newcomers(
            archive, parentless(moved, self.slots, "cma-mega"), newcomers(self.newcomer, keys)
        )
        state = replace(
            state,
            theta=theta,
            distribution=distribution,
            z=z,
            weights=weights.at[:, 0].set(jnp.abs(weights[:, 0])),
            due=jnp.any(archive.occupied),
        )
        return children, state, None

    def to_differentiate(self, state: CmaMegaState, children: Children) -> Genotype:
        return Vector(state.theta[None])

    def learn(
        self, state: CmaMegaState, children: Children, slopes: Slopes
    ) -> tuple[Children, CmaMegaState]:
        assert isinstance(children.genotypes, Vector)
        rows = jnp.where(slopes.finite[0], unit(slopes.rows[0]), 0.0)
        values = jnp.clip(state.theta[None] + product(state.weights, rows), -1.0, 1.0)
        values = jnp.where(state.due, values, children.genotypes.values)
        return replace(children, genotypes=Vector(values)), replace(state, slopes=rows)

    def tell(self, state: CmaMegaState, outcome: Outcome) -> CmaMegaState:
        """Rank children by their gain, those in empty cells first; move θ and adapt."""
        gain = jnp.where(outcome.fresh, outcome.fitness, outcome.improvement)
        gain = jnp.where(outcome.feasible, gain, -jnp.inf)
        order = jnp.lexsort((-gain, ~(outcome.fresh & outcome.entered)))
        strategy = es.strategy(self.outputs, self.slots)
        best = state.weights[order[: len(strategy.weights)]]
        mean = jnp.asarray(strategy.weights, best.dtype)[None]
        ahead = product(product(mean, best), state.slopes)[0]
        distribution = es.update(state.distribution, state.z, order, strategy)
        stuck = ~jnp.any(outcome.entered) | es.must_restart(distribution)
        return replace(
            state,
            theta=jnp.clip(state.theta + self.rate * ahead, -1.0, 1.0),
            distribution=distribution,
            restart=stuck | ~state.due,
        )

    def _anew(self, theta: Float[Array, "gene"]) -> es.Distribution:
        return es.start(jnp.zeros(self.outputs, theta.dtype), self.step)
