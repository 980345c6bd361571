"""Thousands of random plans and their bodies, or some hundreds of them."""

import body_plans
import jax
import pytest

MANY = 3_000


@pytest.fixture(
    scope="session", params=[400, pytest.param(MANY, marks=pytest.mark.long)], ids=str
)
def population(request):
    """Plans after up to 30 mutations, and what has grown from each."""
    keys = jax.random.split(jax.random.key(request.param), request.param)
    grow = jax.jit(jax.vmap(body_plans.developed))
    plans = jax.jit(jax.vmap(lambda key: body_plans.mutated(key, 30)))(keys)
    return jax.device_get((plans, *grow(plans)))
