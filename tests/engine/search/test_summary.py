"""The native kernel's measures, poses and status of a motion are those of JAX, to rounding."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kernel_scenes import SCENES, run

from microcosmos import search, world
from microcosmos.genomes import Drive
from microcosmos.search.evaluation import poses_of, status
from microcosmos.search.simulation import clock_of
from microcosmos.search.window import SUMMARISED, summarise

kernels = pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
LENGTH = 20.0


def moved(name):
    """A scene, and what the kernel's rollout of it gave."""
    scene = SCENES[name]()
    return *scene, *run(world.native.rollout, scene)


def by_kernel(scene, period, instruction_set=None):
    def all_of(box, start, rest, end, observed):
        clock = clock_of(Drive(box, start, rest), len(observed.power))
        given = start, end, observed, clock, period, LENGTH, instruction_set
        return summarise(box, *given)

    return eqx.filter_jit(all_of)(*scene)


def by_jax(scene, period):
    def all_of(box, start, rest, end, observed):
        task, driven = (
            search.Task(box, start, length=LENGTH, period=period),
            Drive(box, start, rest),
        )
        values = search.motion_of(task, driven, end, observed)
        return values, poses_of(task, driven, observed), status(box, end, values["mach"])

    return eqx.filter_jit(all_of)(*scene)


QUICK = ("sweeps", "three bodies", "two nodes", "a body that has grown")


@pytest.mark.parametrize(
    "name",
    [name if name in QUICK else pytest.param(name, marks=pytest.mark.long) for name in SCENES],
)
def test_measures_poses_and_status_are_those_of_jax(name):
    agree(moved(name), 33.3)


def agree(scene, period):
    found, shown, valid = by_kernel(scene, period)
    expected, poses, outcome = by_jax(scene, period)
    for one in SUMMARISED:
        # JAX adds in single precision.
        np.testing.assert_allclose(found[one], expected[one], 2e-4, 2e-6, err_msg=one)
    assert valid == outcome == 0
    alike = {"positions": 1, "path": 5e-5, "middles": 5e-5, "scale": 1e-6}
    for one in ("positions", "path", "middles", "scale", "length", "present"):
        given = getattr(shown, one), getattr(poses, one)
        np.testing.assert_allclose(*given, rtol=0, atol=alike.get(one, 0), err_msg=one)
    assert shown.window == poses.window


@pytest.mark.parametrize("name", ["sweeps", "a star", "three bodies"])
def test_every_instruction_set_measures_alike(name):
    scene = moved(name)
    found = [by_kernel(scene, 50.0, one) for one in kernels.instruction_sets()]
    for other in found[1:]:
        jax.tree.map(np.testing.assert_array_equal, other, found[0])


@pytest.mark.parametrize("field", ["power", "positions", "speed", "curvature", "force"])
def test_a_number_that_is_none_is_reported(field):
    *scene, observed = moved("sweeps")
    bad = eqx.tree_at(
        lambda one: getattr(one, field), observed, replace_fn=lambda x: x.at[60:80].set(jnp.nan)
    )
    _, _, valid = by_kernel([*scene, bad], 50.0)
    assert search.STATUSES[int(valid)] == "non-finite"


@pytest.mark.parametrize(
    ("value", "expected"),
    [(np.nan, "non-finite"), (np.inf, "non-finite"), (3.0, "supersonic")],
)
def test_the_flow_at_the_end_counts(value, expected):
    box, start, rest, end, observed = moved("sweeps")
    planes = list(end.populations)
    planes[1] = planes[1].at[3, 4].add(value)
    end = replace(end, populations=tuple(planes))
    _, _, valid = by_kernel((box, start, rest, end, observed), 50.0)
    assert search.STATUSES[int(valid)] == expected
