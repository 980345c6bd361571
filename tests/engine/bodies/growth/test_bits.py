"""Growth gives the same bits by NumPy and by JAX, and each time."""

import body_plans
import jax
import numpy as np
import pytest

from microcosmos.bodies import growth

pytestmark = pytest.mark.optimised


def test_numpy_and_jax_grow_the_same_bits(population):
    plans, grown, bones, forms = population
    for index in range(0, len(plans.used), max(1, len(plans.used) // 300)):
        plan = body_plans.member(plans, index)
        found, skeleton = body_plans.in_numpy(plan)
        _require_same(found, body_plans.member(grown, index))
        _require_same(skeleton, body_plans.member(bones, index))
        form = growth.form(
            found.positions, skeleton.edges, found.present, skeleton.edge_present
        )
        for name, value in form.items():
            np.testing.assert_allclose(value, forms[name][index], rtol=2e-4, atol=2e-4)


def test_the_same_keys_give_the_same_bytes_in_any_batch(population):
    plans = population[0]
    count = len(plans.used)
    keys = jax.random.split(jax.random.key(count), count)[:1000]
    again = jax.jit(lambda keys: jax.lax.map(lambda key: body_plans.mutated(key, 30), keys))
    for one, other in zip(jax.device_get(again(keys)), plans, strict=True):
        assert one.tobytes() == other[:1000].tobytes()


def _require_same(one, other):
    for name, a, b in zip(type(one)._fields, one, other, strict=True):
        a, b = np.asarray(a), np.asarray(b)
        assert a.dtype == b.dtype, name
        assert a.tobytes() == b.tobytes(), name
