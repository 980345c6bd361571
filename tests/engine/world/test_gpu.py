"""The kernel for GPUs, interpreted on the CPU, against the steps of `stepping`."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, coupling, filaments, groups, world
from microcosmos.build.scene import build_layout, build_rods

NODES, SIZE = 5, (12, 16)


def scene(steps: int, **form):
    """A chain that leaves its box, and bends, stretches and is at times limited."""
    body = bodies.chain(NODES, 1.0, stretch=1.0, shear=1.0, bend=1.0)
    box = world.World(
        jnp.asarray(0.05),
        build_rods(body, float),
        groups.single(NODES),
        SIZE,
        limits=world.Limits(jnp.asarray(0.1), jnp.asarray(0.05)),
        layout=build_layout(body, float),
        form=world.Form(**form),
    )
    place = np.array([1.99, 15.99])  # The first node is beyond one edge and near the other.
    start = world.at_rest(box, jnp.asarray(body.positions - body.positions.mean(0) + place))
    time = np.arange(steps)[:, None]
    angle = 0.05 * time * np.sin(np.arange(NODES - 2) - 0.7 * time)
    length = 1 + 0.02 * time * np.sin(time + np.arange(NODES - 1))
    return box, start, filaments.Rest(jnp.asarray(angle), jnp.asarray(length))


def both(box, start, rest):
    """The rollouts of JAX and of the kernel."""
    expected = jax.jit(lambda r: world.rollout(box, start, r, lambda _, m: m))(rest)
    found = jax.jit(lambda r: world.gpu.rollout(box, start, r, interpreted=True))(rest)
    return expected, found


@pytest.mark.long
@pytest.mark.usefixtures("float64")
@pytest.mark.parametrize(
    ("steps", "present", "form"),
    [
        (7, None, {}),
        (
            6,
            np.arange(NODES) > 0,
            {"projection": coupling.force_free, "kernel": coupling.PESKIN, "force_factor": 1.0},
        ),
    ],
)
def test_the_kernel_takes_the_steps_of_jax(steps, present, form):
    box, start, rest = scene(steps, **form)
    box = replace(box, present=None if present is None else jnp.asarray(present))
    (end, measures), (found, observed) = both(box, start, rest)
    for name in world.native.OBSERVED:
        np.testing.assert_allclose(getattr(observed, name), getattr(measures, name), atol=1e-12)
    for plane, other in zip(found.populations, end.populations, strict=True):
        np.testing.assert_allclose(plane, other, atol=1e-14)
    np.testing.assert_allclose(found.angles, end.angles, atol=1e-12)
    held = np.asarray(measures.held)
    assert held.max() > 0
    assert held.min() < 1


@pytest.mark.long
def test_worlds_of_a_batch_do_not_depend_on_each_other():
    box, start, rest = scene(2)
    rests = jax.tree.map(lambda x: jnp.stack([x, 0.9 * x]), rest)
    run = jax.jit(lambda r: world.gpu.rollout(box, start, r, interpreted=True)[0].positions)
    together = jax.jit(jax.vmap(run))(rests)
    for number in range(2):
        alone = run(jax.tree.map(lambda x, number=number: x[number], rests))
        np.testing.assert_array_equal(together[number], alone)


@pytest.mark.long
def test_positions_that_are_not_finite_stay_in_memory_and_spread():
    box, start, rest = scene(2)
    start = replace(start, positions=start.positions.at[0, 0].set(jnp.nan))
    end, _ = world.gpu.rollout(box, start, rest, interpreted=True)
    assert bool(jnp.isnan(end.positions).all())
    assert bool(jnp.isnan(end.populations[0]).any())


def test_what_the_kernel_lacks_is_named():
    box, start, _ = scene(1)
    box = replace(box, viscosity=jnp.float32(0.05))
    start = jax.tree.map(lambda x: x.astype(jnp.float32), start)
    assert world.gpu.uncovered(box, start) is None
    for part, reason in (
        ({"layout": None}, "constraints that are swept"),
        ({"form": world.Form(layers=2)}, "layers"),
        ({"form": world.Form(fluid=False)}, "no fluid"),
        (
            {"form": world.Form(projection=lambda *given: coupling.force_free(*given))},
            "forcing of another projection",
        ),
    ):
        assert world.gpu.uncovered(replace(box, **part), start) == reason
    assert not world.gpu.chosen(box, start)  # There is no GPU here.
