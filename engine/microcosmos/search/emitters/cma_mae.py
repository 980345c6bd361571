"""CMA-MAE (Fontaine and Nikolaidis, GECCO 2023): evolution strategies with cell thresholds.

Evolution strategies rank their children by how far they are above their cells' thresholds,
which then move towards the fitness found there. The batch update is that of Tjanaka
et al., GECCO 2023 (pyribs), section on archives with learning rates.
"""

from dataclasses import dataclass, replace
from functools import partial

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
    """The state of the emitter; each strategy has its own distribution."""

    distribution: es.Distribution
    z: Float[Array, "strategy child gene"]
    """The normal numbers behind the present children."""
    thresholds: Float[Array, "cell"]
    """One for each cell, which all strategies share."""
    restart: Bool[Array, "strategy"]
    """True if the strategy restarts at an elite."""


@dataclass(frozen=True)
class CmaMae:
    """Strategies whose children fill the emitter's slots; genes are cut at −1 and 1.

    Raises `ValueError` unless the slots divide evenly among the strategies.
    """

    slots: int
    newcomer: Newcomer
    cells: int
    step: float
    learning_rate: float
    threshold: float
    emitters: int = 1
    """Number of strategies."""

    def __post_init__(self) -> None:
        if self.emitters < 1 or self.slots % self.emitters:
            raise ValueError(
                f"`slots` must be a multiple of `emitters` ({self.emitters}), got {self.slots}"
            )

    def init(self, *, key: PRNGKeyArray) -> CmaMaeState:
        mean = jnp.zeros_like(self.newcomer(key=key).values)
        children = self.slots // self.emitters
        return CmaMaeState(
            distribution=jax.tree.map(
                lambda x: jnp.repeat(x[None], self.emitters, 0), es.start(mean, self.step)
            ),
            z=jnp.zeros((self.emitters, children, mean.shape[0]), mean.dtype),
            thresholds=jnp.full(self.cells, self.threshold, mean.dtype),
            restart=jnp.ones(self.emitters, bool),
        )

    def emit(
        self, state: CmaMaeState, archive: Elites, *, keys: Keys
    ) -> tuple[Children, CmaMaeState, None]:
        genes = archive.genotypes
        assert isinstance(genes, Vector)

        def strategy(restart, before, keys):
            chosen = draw(archive, key=jax.random.fold_in(keys[0], 1))
            # In an empty archive the first row is zeros, the middle of the range.
            anew = es.start(genes.values[chosen], self.step)
            distribution = es.restarted(restart, anew, before)
            return distribution, *es.draw(distribution, keys=keys)

        keys = keys.reshape(self.emitters, -1)
        distribution, values, z = jax.vmap(strategy)(state.restart, state.distribution, keys)
        values = jnp.clip(values.reshape(self.slots, -1), -1.0, 1.0)
        children = parentless(Vector(values), self.slots, "cma-mae")
        restart = jnp.zeros(self.emitters, bool)
        return children, replace(state, distribution=distribution, z=z, restart=restart), None

    def tell(self, state: CmaMaeState, outcome: Outcome) -> CmaMaeState:
        here = state.thresholds[jnp.minimum(outcome.cell, self.cells - 1)]
        height = jnp.where(outcome.feasible, outcome.fitness - here, -jnp.inf)
        heights = height.reshape(self.emitters, -1)
        order = jnp.argsort(-heights, axis=1, stable=True)
        strategy = es.strategy(state.z.shape[2], state.z.shape[1])
        update = jax.vmap(partial(es.update, strategy=strategy))
        distribution = update(state.distribution, state.z, order)
        flat = (jnp.max(heights, 1) - jnp.min(heights, 1)) < 1e-12
        return replace(
            state,
            distribution=distribution,
            thresholds=self._updated_thresholds(state.thresholds, outcome, height > 0),
            restart=jax.vmap(es.must_restart)(distribution) | flat,
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
