"""Copies of a creature in one fluid."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from genotypes import any_genotype

from microcosmos import search, spec
from microcosmos.build import build_stroke, build_task
from microcosmos.genomes import Drive
from microcosmos.world import native

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
        _, _, end, _ = swum(gait(column(14)), jnp.dtype("float64"), mirrored)
        one, other = np.split(np.asarray(end.positions), 2)
        np.testing.assert_allclose(other * [1, -1] + [0, 96], one, atol=1e-8)
        assert np.abs(one - other - [0, -14]).max() > 0.01


@pytest.mark.long
def test_far_copies_swim_like_one():
    """Four copies in four boxes side by side have the images that one has in its box."""
    with jax.enable_x64(True):
        dtype = jnp.dtype("float64")
        task, driven, end, seen = swum(gait(size=(48, 48)), dtype)
        alone = motion_of(task, driven, end, seen)
        many = {"count": 4, "arrangement": "grid", "spacing": 48}
        task, driven, last, seen = swum(gait(many), dtype)
        school = motion_of(task, driven, last, seen)
        for place, one in zip(
            np.asarray(task.places), np.split(np.asarray(last.positions), 4), strict=True
        ):
            np.testing.assert_allclose(one - place - 24, end.positions, atol=1e-8)
        for name in ("speed", "displacement", "symmetry", "curvature_mean", "rotation", "mach"):
            np.testing.assert_allclose(school[name], alone[name], rtol=1e-6, atol=1e-9)
        for name in ("power", "nodes", "cost_of_transport"):
            np.testing.assert_allclose(school[name], 4 * alone[name], rtol=1e-6)


@pytest.mark.long
def test_neighbours_change_how_a_creature_swims():
    _, _, end, _ = swum(gait(column(12)))
    _, _, alone, _ = swum(gait())
    one = np.asarray(end.positions)[: len(alone.positions)]
    moved = np.abs(one - np.asarray(alone.positions) - [0, -6]).max()
    assert 0.02 < moved < 5


CASES = {
    "matched": {},
    "steric": {"steric": {}},
    "energy": {"energy": {"packets": 3, "consume": True}},
}


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_the_kernel_simulates_a_school(name):
    pytest.importorskip("microcosmos_kernels")
    scene = gait(column(12, 3), steps=60, **CASES[name])
    _, driven, end, seen = swum(scene)
    found, observed = native.rollout(driven.world, driven.start, driven.inputs)
    np.testing.assert_allclose(found.positions, end.positions, atol=2e-4)
    np.testing.assert_allclose(observed.force, seen.force, atol=1e-5)


CONTROLS = {
    "network": {"encoding": "cppn"},
    "recurrent network": {"encoding": "cppn", "recurrent": True},
    "genes": {"encoding": "direct"},
    "grown body": {"encoding": "cppn-body"},
}


@pytest.mark.long
@pytest.mark.parametrize("name", CONTROLS)
def test_every_encoding_has_schools(name):
    """The kernel, where there is one, measures what JAX does."""
    scene = spec.Scene.model_validate(
        {
            "world": {"width": 32, "height": 40, "copies": column(12)},
            "body": {"nodes": 10},
            "control": {"period": 20, **CONTROLS[name]},
            "task": {"steps": 60},
        }
    )
    task = build_task(scene, room=(12, 20))
    genotype = any_genotype(scene, task.encoding, np.random.default_rng(3))
    found = jax.jit(lambda one: search.evaluate(task, one))(genotype)
    assert found.status == 0
    assert found.poses.positions.shape[1] == 20

    @jax.jit
    def in_jax(genotype):
        driven = search.drive(task, genotype, differentiable=True)
        given = search.simulate(driven, differentiable=True)
        return driven.start.positions, search.motion_of(task, driven, *given)

    start, values = jax.device_get(in_jax(genotype))
    np.testing.assert_allclose(start[10:] - start[:10], [[0, 12]] * 10, atol=1e-5)
    for measure in ("displacement", "symmetry", "nodes", "advance", "wave_number", "power"):
        at = search.MEASURES.index(measure)
        np.testing.assert_allclose(
            found.measures[at], values[measure], rtol=0.02, atol=2e-4, err_msg=measure
        )


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
