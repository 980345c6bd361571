"""The evolution strategy with matrix adaptation: CMA-ES without a decomposition.

Beyer and Sendhoff, IEEE Trans. Evol. Comput. 21, 746 (2017), fig. 7, with the weights and
rates of Hansen, arXiv:1604.00772 (2016), table 1. Letters are theirs: σ the step, M the
matrix whose M Mᵀ is the covariance, s the path, z what is drawn and d = M z.
"""

from dataclasses import dataclass
from math import sqrt

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Key

from ...exact import logarithm
from ...portable import long_product as product

SMALLEST, LARGEST = 1e-10, 1e4
"""Standard deviations beyond which a distribution has converged or diverged."""


class Distribution(eqx.Module):
    """A normal distribution of children, or a batch of them."""

    mean: Float[Array, "*batch gene"]
    sigma: Float[Array, "*batch"]
    m: Float[Array, "*batch gene gene"]
    s: Float[Array, "*batch gene"]


@dataclass(frozen=True)
class Strategy:
    """Weights and rates for a number of genes and children."""

    weights: np.ndarray
    """Weights of the better half of the children, the best first; they sum to 1."""
    mu_eff: float
    """The effective number of children, by variance."""
    c_s: float
    c_1: float
    c_w: float
    d_s: float
    expected_length: float
    """The expected length of a vector drawn from N(0, I)."""


def strategy(genes: int, children: int) -> Strategy:
    """Return the weights and rates of Hansen, table 1."""
    half = max(1, children // 2)
    # By `exact`: a logarithm of the C library may differ in the last bit between machines.
    raw = logarithm((children + 1) / 2) - logarithm(np.arange(1, half + 1))
    raw = np.maximum(raw, 0.0)
    weights = raw / raw.sum() if raw.sum() > 0 else np.ones(1)
    mu_eff = float(1 / np.sum(weights**2))
    c_s = (mu_eff + 2) / (genes + mu_eff + 5)
    c_1 = 2 / ((genes + 1.3) ** 2 + mu_eff)
    spread = 2 * (mu_eff - 2 + 1 / mu_eff)
    beyond = max(0.0, sqrt((mu_eff - 1) / (genes + 1)) - 1)
    return Strategy(
        weights,
        mu_eff,
        c_s,
        c_1,
        c_w=min(1 - c_1, spread / ((genes + 2) ** 2 + mu_eff)),
        d_s=1 + c_s + 2 * beyond,
        expected_length=sqrt(genes) * (1 - 1 / (4 * genes) + 1 / (21 * genes**2)),
    )


def start(mean: Float[Array, "gene"], sigma: float) -> Distribution:
    """Return the distribution around a mean, equal in all directions."""
    genes = mean.shape[0]
    eye = jnp.eye(genes, dtype=mean.dtype)
    return Distribution(mean, jnp.asarray(sigma, mean.dtype), eye, jnp.zeros_like(mean))


def restarted(
    restart: Bool[Array, ""], anew: Distribution, before: Distribution
) -> Distribution:
    """Return the new distribution on a restart, else the one before."""
    return jax.tree.map(lambda one, other: jnp.where(restart, one, other), anew, before)


def draw(
    distribution: Distribution, *, keys: Key[Array, "child"]
) -> tuple[Float[Array, "child gene"], Float[Array, "child gene"]]:
    """Draw children; also return the z of each."""
    mean, m = distribution.mean, distribution.m
    z = jax.vmap(lambda key: jax.random.normal(key, mean.shape, mean.dtype))(keys)
    return mean[None] + distribution.sigma * product(z, m.T), z


def update(
    distribution: Distribution,
    z: Float[Array, "child gene"],
    order: Int[Array, "child"],
    strategy: Strategy,
) -> Distribution:
    """Return the distribution after its children are ranked; `order` has the best first."""
    w = jnp.asarray(strategy.weights, z.dtype)
    best = z[order[: len(w)]]
    d = product(best, distribution.m.T)
    c_s, c_1, c_w = strategy.c_s, strategy.c_1, strategy.c_w
    z_w = jnp.sum(w[:, None] * best, 0)
    s = (1 - c_s) * distribution.s + sqrt(c_s * (2 - c_s) * strategy.mu_eff) * z_w
    rank_one = product(distribution.m, s[:, None]) * s[None]
    rank_mu = product((w[:, None] * d).T, best)
    m = (1 - (c_1 + c_w) / 2) * distribution.m + c_1 / 2 * rank_one + c_w / 2 * rank_mu
    length = jnp.sqrt(jnp.sum(s * s)) / strategy.expected_length
    return Distribution(
        mean=distribution.mean + distribution.sigma * jnp.sum(w[:, None] * d, 0),
        # By the length of the path (Hansen 2016). pyribs takes its square, and its steps are
        # longer (docs/evolution.md, "Benchmark functions").
        sigma=distribution.sigma * jnp.exp(c_s / strategy.d_s * (length - 1)),
        m=m,
        s=s,
    )


def must_restart(distribution: Distribution) -> Bool[Array, ""]:
    """Return whether the distribution has converged, diverged, or is not finite."""
    deviations = distribution.sigma * jnp.sqrt(jnp.sum(distribution.m**2, 1))
    finite = jnp.all(jnp.isfinite(distribution.m)) & jnp.all(jnp.isfinite(distribution.mean))
    useful = (jnp.max(deviations) > SMALLEST) & (jnp.max(deviations) < LARGEST)
    return ~(finite & useful)
