"""Copies of a creature in one fluid."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search, spec
from microcosmos.build import build_stroke, build_task
from microcosmos.genomes import Drive
from microcosmos.world import unwrapped

STEPS, PERIOD = 400, 200
BODY = {"builder": "worm"}
CONTROL = {"swimmer": "worm", "period": PERIOD, "ramp": 0.2}


def gait(copies=None, size=(96, 96), steps=STEPS, body=BODY, **world):
    box = {"width": size[0], "height": size[1], "viscosity": 0.1, "copies": copies} | world
    return spec.Scene.model_validate(
        {"world": box, "body": body, "control": CONTROL, "task": {"steps": steps}}
    )


def swum(scene, dtype=jnp.float32, change=None):
    """Simulate a gait in JAX; return the task, the simulation, its end and its measures."""
    task = build_task(scene, dtype)

    @jax.jit
    def swim(stroke):
        driven = search.drive(task, stroke)
        driven = driven if change is None else change(driven)
        given = driven.world, driven.start, driven.inputs
        return given, search.simulate(driven, differentiable=True)

    given, (end, seen) = swim(build_stroke(scene.control, scene.task.steps, dtype))
    return task, Drive(*given), end, seen


def motion_of(task, driven, end, seen):
    """What a simulation measures, from one program."""
    return jax.jit(lambda *given: search.motion_of(task, driven, *given))(end, seen)


def column(spacing, count=2):
    return {"count": count, "arrangement": "column", "spacing": spacing}


@pytest.mark.parametrize("arrangement", ["row", "column", "grid"])
def test_copies_stand_about_the_middle_at_their_spacing(arrangement):
    copies = spec.Copies(count=4, arrangement=arrangement, spacing=10)
    places = copies.places
    np.testing.assert_allclose(places.mean(0), 0, atol=1e-12)
    away = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    np.testing.assert_allclose((away + 1e9 * np.eye(4)).min(1), 10)
    assert tuple(np.ptp(places, axis=0) / 10 + 1) == copies.shape


def test_mirror_images_stay_mirror_images():
    """Two copies, the second of which bends the other way."""

    def mirrored(driven):
        half = driven.inputs.angle.shape[1] // 2
        angle = driven.inputs.angle.at[:, half:].multiply(-1)
        return replace(driven, inputs=replace(driven.inputs, angle=angle))

    with jax.enable_x64(True):
        _, driven, end, _ = swum(gait(column(14)), jnp.dtype("float64"), mirrored)
        one, other = np.split(np.asarray(unwrapped(driven.world, end)), 2)
        np.testing.assert_allclose(other * [1, -1] + [0, 96], one, atol=1e-8)
        assert np.abs(one - other - [0, -14]).max() > 0.01


@pytest.mark.parametrize("count", [2, 3])
def test_the_middle_of_a_school_is_that_of_its_first_copy(count):
    scene = gait(column(14, count), steps=10)
    task, driven, end, seen = swum(scene)
    middle = search.Measure("middle", lambda motion: motion.middle[-1, 1])
    found = motion_of(replace(task, named_measures=(middle,)), driven, end, seen)
    nodes = len(task.start.positions)
    assert float(found["middle"]) == float(unwrapped(driven.world, end)[nodes // 2, 1])
    assert float(found["nodes"]) == count * nodes == task.copies * nodes


@pytest.mark.long
def test_far_copies_swim_like_one():
    """Four copies in four boxes side by side have the images that one has in its box."""
    with jax.enable_x64(True):
        dtype = jnp.dtype("float64")
        task, driven, end, seen = swum(gait(size=(48, 48)), dtype)
        alone = motion_of(task, driven, end, seen)
        single = unwrapped(driven.world, end)
        many = {"count": 4, "arrangement": "grid", "spacing": 48}
        task, driven, last, seen = swum(gait(many), dtype)
        school = motion_of(task, driven, last, seen)
        for place, one in zip(
            np.asarray(task.places),
            np.split(np.asarray(unwrapped(driven.world, last)), 4),
            strict=True,
        ):
            np.testing.assert_allclose(one - place - 24, single, atol=1e-8)
        for name in ("speed", "displacement", "symmetry", "curvature_mean", "rotation", "mach"):
            np.testing.assert_allclose(school[name], alone[name], rtol=1e-6, atol=1e-9)
        for name in ("power", "nodes", "cost_of_transport"):
            np.testing.assert_allclose(school[name], 4 * alone[name], rtol=1e-6)


@pytest.mark.parametrize(
    ("world", "message"),
    [
        ({"copies": column(2)}, "`world.copies.spacing` must be at least 3 cells"),
        ({"copies": column(20, 4)}, "`world.height` must be at least 63 cells for 4"),
        (
            {"copies": {"arrangement": "row", "spacing": 16}},
            "`world.copies.spacing` must be at least 26 cells for a `body` that",
        ),
    ],
)
def test_copies_that_do_not_fit_are_refused(world, message):
    with pytest.raises(ValueError, match=message):
        spec.Scene.model_validate({"world": world})


def test_copies_in_closed_loop_are_refused():
    world = {"copies": column(10), "energy": {}}
    with pytest.raises(ValueError, match=r"`control.sense_energy` must be false"):
        spec.Scene.model_validate({"world": world, "control": {"sense_energy": True}})
