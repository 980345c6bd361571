"""The verdict on an evaluation by its recorded measures."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos.search import MEASURES, STATUSES, Evaluation, judged

pytestmark = pytest.mark.fast


def verdict(status=0, **measures):
    row = np.zeros((1, len(MEASURES)), np.float32)
    for name, value in measures.items():
        row[0, MEASURES.index(name)] = value
    given = Evaluation(jnp.zeros(1), jnp.asarray(row), jnp.full(1, status, jnp.int32))
    found, compiled = judged(given).status, jax.jit(judged)(given).status
    np.testing.assert_array_equal(found, compiled)
    assert found.dtype == np.int32
    return STATUSES[int(found[0])]


@pytest.mark.parametrize(
    ("measures", "expected"),
    [
        ({"limited": 0.00099, "mach": 0.1699, "impulse": 0.99e-4}, "ok"),
        ({"limited": 0.00101}, "limits"),
        ({"mach": 0.171}, "compressible"),
        ({"impulse": 1.01e-4}, "impulse"),
        ({"crossing": 1 / 64}, "crossing"),
        ({"limited": 0.5, "mach": 0.5, "impulse": 1.0}, "limits"),
    ],
)
def test_each_bar_decides(measures, expected):
    assert verdict(**measures) == expected


def test_an_earlier_reason_stays():
    assert verdict(STATUSES.index("supersonic"), limited=0.5) == "supersonic"
