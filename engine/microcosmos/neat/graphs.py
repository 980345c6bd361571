"""NEAT's operators on all genotypes with numbered genes: networks, and plans with networks."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray

from ..genomes import BodyGraph, Graph
from . import alignment, mutation
from .alignment import Coefficients
from .mutation import Novelty
from .plans import crossover_plan, mutate_plan, plan_distance
from .rows import NONE
from .settings import Rates


def mutate(
    genotype: Graph, rates: Rates, inputs: int, outputs: int | None = None, *, key: PRNGKeyArray
) -> tuple[Graph, Novelty]:
    """Return a child of one parent, and its genes that need numbers.

    If the structure of a plan changes, the network stays. Raises `ValueError` as
    `mutation.mutate` does.
    """
    if not isinstance(genotype, BodyGraph):
        return mutation.mutate(genotype, rates, inputs, outputs, key=key)
    assert rates.plan is not None
    plan_key, network_key = jax.random.split(key)
    plan, segment = mutate_plan(genotype.plan, rates.plan, key=plan_key)
    network, novelty = mutation.mutate(
        genotype.network, rates, inputs, outputs, key=network_key
    )
    # Fitness then tests the new body with a controller that is known.
    kept = segment.changed
    network = jax.tree.map(lambda a, b: jnp.where(kept, a, b), genotype.network, network)
    novelty = jax.tree.map(lambda row: jnp.where(kept, NONE, row), novelty)
    return BodyGraph(plan, network), replace(novelty, segment=segment.novelty)


def crossover(
    fitter: Graph,
    other: Graph,
    average: float = 0.0,
    disabled: float = 0.75,
    *,
    key: PRNGKeyArray,
) -> Graph:
    """Return a child with the structure of the fitter parent, and matching genes of either.

    See `alignment.crossover` for networks; each matching segment is inherited whole.
    """
    if not isinstance(fitter, BodyGraph):
        assert not isinstance(other, BodyGraph)
        return alignment.crossover(fitter, other, average, disabled, key=key)
    assert isinstance(other, BodyGraph)
    plan_key, network_key = jax.random.split(key)
    network = alignment.crossover(
        fitter.network, other.network, average, disabled, key=network_key
    )
    return BodyGraph(crossover_plan(fitter.plan, other.plan, key=plan_key), network)


def distance(a: Graph, b: Graph, coefficients: Coefficients) -> Float[Array, ""]:
    """Return NEAT's distance; that of two-part genotypes is the sum over both parts."""
    if not isinstance(a, BodyGraph):
        assert not isinstance(b, BodyGraph)
        return alignment.distance(a, b, coefficients)
    assert isinstance(b, BodyGraph)
    bodies = plan_distance(a.plan, b.plan, coefficients)
    return bodies + alignment.distance(a.network, b.network, coefficients)
