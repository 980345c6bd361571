"""CMA-MAE (Fontaine and Nikolaidis, GECCO 2023): evolution strategy with cell thresholds.

An evolution strategy ranks its children by how far they are above their cells' thresholds,
which then move towards the fitness found there. The batch update is that of Tjanaka
et al., GECCO 2023 (pyribs), section on archives with learning rates.
"""

from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from ...genomes import Vector
from ...portable import power
from ..insertion import Elites
from . import matrix_adaptation as es
from .elites import Newcomer, parentless
from .emitter import Children, Keys, Outcome
from .selection import draw


class CmaMaeState(eqx.Module):
    """The state of the emitter."""

    distribution: es.Distribution
    z: Float[Array, "slot gene"]
    """The normal numbers behind the present children."""
    thresholds: Float[Array, "cell"]
    restart: Bool[Array, ""]
    """True if the search restarts at an elite."""


@dataclass(frozen=True)
class CmaMae:
    """One strategy whose children fill the emitter's slots; genes are cut at −1 and 1."""

    slots: int
    newcomer: Newcomer
    cells: int
    step: float
    learning_rate: float
    threshold: float

    def init(self, *, key: PRNGKeyArray) -> CmaMaeState:
        mean = jnp.zeros_like(self.newcomer(key=key).values)
        return CmaMaeState(
            distribution=es.start(mean, self.step),
            z=jnp.zeros((self.slots, mean.shape[0]), mean.dtype),
            thresholds=jnp.full(self.cells, self.threshold, mean.dtype),
            restart=jnp.ones((), bool),
        )

    def emit(
        self, state: CmaMaeState, archive: Elites, *, keys: Keys
    ) -> tuple[Children, CmaMaeState, None]:
        chosen = draw(archive, key=jax.random.fold_in(keys[0], 1))
        genotypes = archive.genotypes
        assert isinstance(genotypes, Vector)
        # In an empty archive the first row is zeros, the middle of the range.
        anew = es.start(genotypes.values[chosen], self.step)
        distribution = es.restarted(state.restart, anew, state.distribution)
        values, z = es.draw(distribution, keys=keys)
        children = parentless(Vector(jnp.clip(values, -1.0, 1.0)), self.slots, "cma-mae")
        state = replace(state, distribution=distribution, z=z, restart=jnp.zeros((), bool))
        return children, state, None

    def tell(self, state: CmaMaeState, outcome: Outcome) -> CmaMaeState:
        here = state.thresholds[jnp.minimum(outcome.cell, self.cells - 1)]
        height = jnp.where(outcome.feasible, outcome.fitness - here, -jnp.inf)
        order = jnp.argsort(-height, stable=True)
        strategy = es.strategy(state.z.shape[1], self.slots)
        distribution = es.update(state.distribution, state.z, order, strategy)
        flat = (height[order[0]] - height[order[-1]]) < 1e-12
        return replace(
            state,
            distribution=distribution,
            thresholds=self._updated_thresholds(state.thresholds, outcome, height > 0),
            restart=es.must_restart(distribution) | flat,
        )

    def _updated_thresholds(
        self, thresholds: Float[Array, "cell"], outcome: Outcome, above: Bool[Array, "slot"]
    ) -> Float[Array, "cell"]:
        """Return t + (1 − (1 − α)ᵏ) (f − t) after k children of mean fitness f in a cell."""
        cell = jnp.where(above, outcome.cell, self.cells)
        fitness = jnp.where(above, outcome.fitness, 0.0)
        none = jnp.zeros_like(thresholds)
        count = none.at[cell].add(1.0, mode="drop")
        mean = none.at[cell].add(fitness, mode="drop") / jnp.maximum(count, 1.0)
        kept = power(1.0 - self.learning_rate, count)
        return jnp.where(count > 0, kept * thresholds + (1 - kept) * mean, thresholds)
