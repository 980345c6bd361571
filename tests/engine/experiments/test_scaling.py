"""A measurement of wall time: its rows and its fit."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import device
from microcosmos.build.experiments import build_crowd
from microcosmos.experiments.scaling import (
    LINEAR_FROM,
    Timing,
    _all_pairs,
    step_row,
    summary,
)
from microcosmos.spec import parse

PARTS = ("fluid", "coupling", "constraints", "steric")


def row(nodes, seconds, **change):
    values = {"method": "microcosmos", "nodes": nodes, "seconds": seconds, "fluid": 2.0}
    return values | {"memory_bytes": 10 * nodes, "status": "ok"} | change


def test_rows_tell_the_whole_and_its_parts(course_of):
    (*_, state), (*_, report), *_ = course_of("scaling")
    ours, pairs, more = (row.values for row in state.rows)
    assert [(r["method"], r["nodes"]) for r in (ours, pairs, more)] == [
        ("microcosmos", 40),
        ("all-pairs", 40),
        ("microcosmos", 80),
    ]
    for values in (ours, more):
        assert values["status"] == "ok"
        assert values["steps"] == 10
        assert all(values[part] > 0 for part in ("seconds", *PARTS))
    assert all(pairs[part] is None for part in PARTS)
    # Nine planes before and after a step are the least there is.
    assert ours["memory_bytes"] >= 2 * 9 * 32 * 32 * 4
    assert more["memory_bytes"] > ours["memory_bytes"]
    assert report.summary["peak_memory_bytes"] == more["memory_bytes"]
    assert report.infeasible == 0


@pytest.mark.long
@pytest.mark.parametrize("kernel", ["native", "jax"])
def test_the_chosen_kernel_is_measured(specs, monkeypatch, kernel):
    if kernel == "native" and device.kernel_version() is None:
        pytest.skip("the native kernel is not installed")
    monkeypatch.setenv(device.KERNEL_VARIABLE, kernel)
    calls, plan = [], Timing(250, 2, {}, lambda: bool(calls.append(None)))
    found = step_row(*build_crowd(parse(specs["scaling"]), 40), plan)
    assert (found["kernel"], found["status"], found["nodes"]) == (kernel, "ok", 40)
    assert all(found[part] > 0 for part in ("seconds", *PARTS))
    assert found["memory_bytes"] >= 2 * 9 * 32 * 32 * 4
    whole = {"native": 2, "jax": 25 + 4 * 3}  # Calls: JAX's parts have their own.
    assert len(calls) == whole[kernel]
    assert found["steps"] == {"native": 200, "jax": 250}[kernel]


@pytest.mark.fast
@pytest.mark.parametrize("slope", [1.0, 1.3])
def test_the_exponent_is_the_slope_of_what_depends_on_nodes(slope):
    nodes = [1_000, 16_000, 32_000, 64_000]
    rows = [row(n, 2.0 + 1e-4 * n**slope) for n in nodes]
    rows[0]["seconds"] = 50.0  # Below the fit.
    rows += [row(n, 1e-6 * n**2.0, method="all-pairs", fluid=None) for n in (2000, 4000, 8000)]
    found = summary(rows)
    assert found["exponent"] == pytest.approx(slope, rel=1e-9)
    assert found["exponent_all_pairs"] == pytest.approx(2.0, rel=1e-9)
    assert found["exponent_from"] == LINEAR_FROM == 16_000
    assert found["peak_memory_bytes"] == 640_000


def test_all_pairs_repel_by_the_gradient_of_a_gaussian(float64):
    two = jnp.asarray([[1.0, 5.0], [31.5, 5.0]])
    expected = 1.5 * np.exp(-(1.5**2) / 2)
    np.testing.assert_allclose(_all_pairs(two, (32, 32)), [[expected, 0], [-expected, 0]])
