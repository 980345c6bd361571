"""Folding: gradient descent of a filament's rest shape towards a picture.

As in the Microcosmos paper: the loss is the mean squared difference at the end between the
density of nodes, splatted as Gaussians, and the picture. Steps are those of Adam (Kingma and
Ba, ICLR 2015, algorithm 1, with its defaults).
"""

from collections.abc import Callable
from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .. import fields
from ..genomes import Vector
from .simulation import drive, simulate
from .task import Task

Plane = Float[Array, "x y"]

BETA_1, BETA_2, EPSILON = 0.9, 0.999, 1e-8

Moments = Float[Array, "*block gene"]


class Adam(eqx.Module):
    """Moments of the slopes so far."""

    count: Int[Array, "*block"]
    mean: Moments
    square: Moments


def begin(genes: Float[Array, "gene"]) -> Adam:
    none = jnp.zeros_like(genes)
    return Adam(jnp.zeros((), jnp.int32), none, none)


def descend(
    adam: Adam, slope: Float[Array, "gene"], rate: float | Float[Array, ""]
) -> tuple[Float[Array, "gene"], Adam]:
    """Return the descending change of genes, and the new state."""
    count = adam.count + 1
    mean = BETA_1 * adam.mean + (1 - BETA_1) * slope
    square = BETA_2 * adam.square + (1 - BETA_2) * slope * slope
    n = count.astype(slope.dtype)
    towards, spread = mean / (1 - BETA_1**n), square / (1 - BETA_2**n)
    return -rate * towards / (jnp.sqrt(spread) + EPSILON), Adam(count, mean, square)


class Fold(eqx.Module):
    """The state of one filament, or of a block of them."""

    genes: Float[Array, "*block gene"]
    optimiser: Adam
    best: Float[Array, "*block gene"]
    """The genes with the least loss so far."""
    least: Float[Array, "*block"]
    rate_share: Float[Array, "*block"]
    """Share of the learning rate; halved after each update that failed."""
    picture: Float[Array, "*block x y"]


class Descent(eqx.Module):
    """The settings of an update."""

    task: Task
    width: float = eqx.field(static=True, default=1.5)
    """Standard deviation of a node's Gaussian, in cells."""
    density: Callable[[Plane], Plane] = eqx.field(static=True, default=fields.saturated)
    rate: float = eqx.field(static=True, default=0.04)
    """Learning rate of Adam."""
    segment: int | None = eqx.field(static=True, default=None)
    """Steps that reverse mode keeps at a time; None: all."""


def loss(descent: Descent, genes: Float[Array, "gene"], picture: Plane) -> Float[Array, ""]:
    """Return the mean squared difference between density and picture at the end."""
    driven = drive(descent.task, Vector(genes), differentiable=True)
    end, _ = simulate(driven, lambda state, measures: None, segment=descent.segment)
    density = fields.splat(end.positions, descent.task.world.size, descent.width)
    return jnp.mean((descent.density(density) - picture) ** 2)


def initial_fold(descent: Descent, picture: Plane) -> Fold:
    """Return a filament before the first update."""
    assert descent.task.encoding is not None
    genes = descent.task.encoding.newcomer(key=jax.random.key(0)).values
    least = jnp.full((), jnp.inf, genes.dtype)
    return Fold(genes, begin(genes), genes, least, jnp.ones_like(least), picture)


def update(descent: Descent, fold: Fold) -> tuple[Fold, Float[Array, ""]]:
    """Return the fold after one step of Adam, and the loss before it.

    If loss or slope are not finite, the loss is NaN, and the next step starts from the
    best genes at half the rate.
    """
    value, slope = jax.value_and_grad(partial(loss, descent))(fold.genes, fold.picture)
    finite = jnp.isfinite(value) & jnp.all(jnp.isfinite(slope))
    better = finite & (value < fold.least)
    best = jnp.where(better, fold.genes, fold.best)
    rate = descent.rate * fold.rate_share
    # A number that is not finite would stay in the moments of Adam.
    change, moved = descend(fold.optimiser, jnp.where(finite, slope, 0.0), rate)
    genes = jnp.where(finite, fold.genes + change, best)
    optimiser = jax.tree.map(
        lambda new, fresh: jnp.where(finite, new, fresh), moved, begin(best)
    )
    least = jnp.where(better, value, fold.least)
    rate_share = jnp.where(finite, 1.0, 0.5) * fold.rate_share
    loss_before = jnp.where(finite, value, jnp.nan)
    return Fold(genes, optimiser, best, least, rate_share, fold.picture), loss_before


def start(descent: Descent, pictures: Float[np.ndarray, "fold x y"]) -> Fold:
    """Return all folds before the first update, as NumPy arrays."""
    block = jax.vmap(lambda picture: initial_fold(descent, picture))(jnp.asarray(pictures))
    return jax.device_get(block)
