"""Evolution strategies as emitters: CMA-MAE and CMA-MEGA, with matrix adaptation.

CMA-MAE (Fontaine and Nikolaidis, GECCO 2023): strategies rank their children by how far they
are above their cells' thresholds, which then move towards the fitness found there. The batch
update is that of Tjanaka et al., GECCO 2023 (pyribs), section on archives with learning rates.

CMA-MEGA (Fontaine and Nikolaidis, NeurIPS 2021, algorithm 2): one solution θ moves along the
slopes of fitness and descriptors. Its children are θ plus random combinations of the unit
slopes there, drawn from a distribution that adapts to what enters the archive.
"""

from dataclasses import dataclass, replace
from functools import partial
from math import inf
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from ...bounds import refuse_beyond, refuse_uncountable
from ...genomes import Genotype, Vector
from ...portable import power, product
from ..gradients import Slopes, unit
from ..insertion import Elites
from . import matrix_adaptation as es
from .emitter import (
    Children,
    Keys,
    Newcomer,
    Outcome,
    Problem,
    newcomers,
    or_newcomers,
    parentless,
)
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

    Raises `ValueError` unless the slots divide evenly among the strategies, and for numbers
    beyond their bounds.
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
        refuse_uncountable(1, slots=self.slots, cells=self.cells)
        refuse_beyond(0, open=True, step=self.step)
        refuse_beyond(0, 1, learning_rate=self.learning_rate)
        refuse_beyond(-inf, threshold=self.threshold)
        refuse_uncountable(1, emitters=self.emitters)
        if self.slots % self.emitters:
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
        # Without a feasible child the difference is NaN.
        flat = ~(jnp.max(heights, 1) - jnp.min(heights, 1) >= 1e-12)
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
        # `jnp.power` is the C library's, whose last bit depends on the machine.
        kept = power(1.0 - self.learning_rate, count)
        return jnp.where(count > 0, kept * thresholds + (1 - kept) * mean, thresholds)


def build_cma_mae(settings: Any, problem: Problem) -> CmaMae:
    return CmaMae(
        slots=problem.slots,
        newcomer=problem.newcomer,
        cells=problem.cells.count,
        step=settings.step,
        learning_rate=settings.learning_rate,
        threshold=settings.threshold,
        emitters=settings.emitters,
    )


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

    def __post_init__(self) -> None:
        refuse_uncountable(1, slots=self.slots, outputs=self.outputs)
        refuse_beyond(0, open=True, step=self.step, rate=self.rate)

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
            # The newcomers of an empty archive came from no distribution, so nothing can be
            # learned.
            restart=stuck | ~state.due,
        )

    def _anew(self, theta: Float[Array, "gene"]) -> es.Distribution:
        return es.start(jnp.zeros(self.outputs, theta.dtype), self.step)


def build_cma_mega(settings: Any, problem: Problem) -> CmaMega:
    outputs = 1 + len(problem.cells.axes)
    return CmaMega(problem.slots, problem.newcomer, outputs, settings.step, settings.rate)
