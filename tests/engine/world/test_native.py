"""The native kernel against JAX: the same steps, to rounding; the same bits on every CPU."""

import os
import subprocess
import sys
from dataclasses import replace
from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import jaxlib.version
import numpy as np
import pytest
from kernel_scenes import OBSERVED, SCENES, controlled, in_jax, run, unwrapped

from microcosmos import coupling, device, fields, filaments, fluid, world
from microcosmos.spec.evolution import UNLIMITED
from microcosmos.version import VERSION

kernels = pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
native = world.native


QUICK = (
    "shape matching",
    "sweeps",
    "three bodies",
    "two layers",
    "the paper's literal form",
    "bodies that touch",
    "energy that is taken and spreads",
    "walls, a uniform force and a sponge",
    "a body kept out of obstacles",
    "bodies that leave their boxes",
    "a body that has grown",
)
"""Scenes of `make test`."""


def quick(name):
    return pytest.param(name, marks=() if name in QUICK else pytest.mark.long)


@pytest.mark.parametrize("name", [quick(name) for name in SCENES])
def test_the_kernel_takes_the_steps_of_jax(name):
    agree(SCENES[name]())


def agree(scene):
    """Compare the kernel with JAX after 1, 10 and 100 steps."""
    end, observed = run(in_jax, scene)
    found, seen = run(native.rollout, scene)
    one, other = (measured(scene, each) for each in (observed, seen))
    for name, expected in one.items():
        # Positions are near 30, of which a float holds 2e-6; motions are their differences.
        tolerance = 1e-5 + 1e-3 * np.abs(expected).max(initial=0)
        for steps in (1, 10, 100):
            np.testing.assert_allclose(
                other[name][:steps], expected[:steps], rtol=0, atol=tolerance
            )
    # A node at the very limit may count or not.
    np.testing.assert_allclose(seen.held, observed.held, atol=1.5 / len(end.positions))
    np.testing.assert_allclose(other["positions"][-1], one["positions"][-1], atol=2e-4)
    np.testing.assert_allclose(found.angles, end.angles, atol=2e-5)
    np.testing.assert_allclose(found.populations, end.populations, atol=3e-5)
    if end.energy is not None:
        np.testing.assert_allclose(found.energy, end.energy, atol=1e-5)
        np.testing.assert_allclose(found.collected, end.collected, rtol=1e-4, atol=1e-4)


def measured(scene, seen):
    """The measures of each step by name."""
    box, start, _ = scene
    found = {name: getattr(seen, name) for name in OBSERVED} | unwrapped(box, start, seen)
    return {name: np.asarray(one) for name, one in found.items()}


@pytest.mark.parametrize(
    "name",
    [
        "shape matching",
        "sweeps",
        "a star",
        "three bodies",
        "two layers",
        "bodies that touch",
        "energy that is taken and spreads",
        "walls, a uniform force and a sponge",
        "bodies that touch, by a Fourier transform",
    ],
)
def test_every_instruction_set_gives_the_same_bits(name):
    sets = kernels.instruction_sets()
    found = [
        run(lambda *given, one=one: native.rollout(*given, one), SCENES[name]()) for one in sets
    ]
    for other in found[1:]:
        jax.tree.map(np.testing.assert_array_equal, other, found[0])


@pytest.mark.long
@pytest.mark.parametrize(
    "control",
    [
        {},
        {"encoding": "direct"},
        {"sense_energy": True, "recurrent": True},
    ],
)
def test_every_instruction_set_develops_the_same_bits(control):
    """In open loop, and in a closed loop with memory."""
    way = native.rollout if control.get("sense_energy") else native.develop
    given = controlled(**control)
    found = [way(*given, one) for one in kernels.instruction_sets()]
    for other in found[1:]:
        jax.tree.map(np.testing.assert_array_equal, other, found[0])


def test_a_memory_that_senses_nothing_commands_the_same_within_a_rollout():
    box, start, controller = controlled(recurrent=True, **UNLIMITED)
    network = controller.commands
    to_itself = network.source.at[0].set(network.target[0])  # An output that is remembered.
    network = replace(network, source=to_itself)
    given = box, start, replace(controller, commands=network)
    rest, _ = jax.jit(native.develop)(*given)
    _, observed = jax.jit(native.rollout)(*given)
    jax.tree.map(np.testing.assert_array_equal, observed.rest, rest)
    assert np.abs(np.asarray(rest.angle)).max() > 0.01


def test_a_rollout_goes_on_where_another_ended():
    box, start, rest = SCENES["shape matching"]()
    whole, _ = run(native.rollout, (box, start, rest))
    half, _ = run(native.rollout, (box, start, rest), 50)
    later = jax.tree.map(lambda x: x[50:], rest)
    jax.tree.map(
        np.testing.assert_array_equal, run(native.rollout, (box, half, later))[0], whole
    )


@pytest.mark.long
def test_a_batch_gives_the_bits_of_each_world():
    box, start, rest = SCENES["shape matching"]()
    sizes = jnp.asarray([0.5, 1.0, 1.5], jnp.float32)
    viscosities = jnp.asarray([0.05, 0.5], jnp.float32)

    def roll(viscosity, size):
        one = filaments.Rest(size * rest.angle, rest.length)
        return native.rollout(replace(box, viscosity=viscosity), start, one)[0]

    batch = jax.vmap(jax.vmap(roll, (None, 0)), (0, None))(viscosities, sizes)
    for i, viscosity in enumerate(viscosities):
        for j, size in enumerate(sizes):
            one = jax.tree.map(lambda x, at=(i, j): x[at], batch)
            jax.tree.map(np.testing.assert_array_equal, one, roll(viscosity, size))


def test_what_is_not_finite_stays_inside_the_world():
    box, start, rest = SCENES["sweeps"]()
    for bad in (np.nan, np.inf, 1e30):
        positions = start.positions.at[3].set(bad)
        end, observed = run(native.rollout, (box, replace(start, positions=positions), rest))
        assert not np.isfinite(observed.centre).all()
        assert not np.isfinite(end.positions).all()


def test_a_flow_that_is_not_finite_has_no_largest_speed():
    box, start, rest = SCENES["sweeps"]()
    for bad in (np.nan, -np.nan):  # The sign of NaN is a bit of its own.
        one, *others = start.populations
        scene = box, replace(start, populations=(one.at[5, 6].set(bad), *others)), rest
        for rollout in (native.rollout, in_jax):
            assert np.isnan(run(rollout, scene)[1].speed).all()


def test_a_derivative_never_passes_through_the_kernel():
    box, start, rest = SCENES["shape matching"]()

    def far(angle):
        return native.rollout(box, start, filaments.Rest(angle, rest.length))[1].centre[-1, 0]

    with pytest.raises(ValueError, match=r"[Dd]ifferentiat"):
        jax.grad(far)(rest.angle)


def test_wrong_shapes_are_refused():
    box, start, rest = SCENES["sweeps"]()
    short = eqx.tree_at(lambda one: one.rods.shear, box, box.rods.shear[:5])
    with pytest.raises(Exception, match=r"shear must have the shape \(19, \).* got \(5, \)"):
        jax.block_until_ready(native.rollout(short, start, rest))
    edges = box.rods.edges.at[0, 0].set(99)
    broken = replace(box, rods=replace(box.rods, edges=edges))
    with pytest.raises(Exception, match="the body or the network refers to what it lacks"):
        jax.block_until_ready(native.rollout(broken, start, rest))


def test_what_the_kernel_lacks_is_left_to_jax(monkeypatch, float64):
    box, start, _ = SCENES["shape matching"]()
    assert native.chosen(box, start)
    repelled = fields.Steric(jnp.float32(4), jnp.float32(0.1), lambda x: jnp.stack([x, x]))
    own = replace(box, steric=repelled)
    assert not native.chosen(own, start)
    for form in (
        world.Form(projection=lambda *given: coupling.force_free(*given)),
        world.Form(kernel=coupling.Kernel(coupling.HAT.weight, 4)),
        world.Form(magic=lambda tau: fluid.fixed_magic(tau)),
    ):
        assert not native.chosen(replace(box, form=form), start)
    exact = replace(start, positions=start.positions.astype(float64))
    assert not native.chosen(box, exact)
    monkeypatch.setenv("MICROCOSMOS_KERNEL", "jax")
    assert not native.chosen(box, start)
    assert "kernels" not in device.device_kind()
    monkeypatch.setenv("MICROCOSMOS_KERNEL", "native")
    assert f"microcosmos-kernels {kernels.__version__}" in device.device_kind()
    with pytest.raises(ValueError, match="does not cover repulsion of another form"):
        native.chosen(own, start)
    with pytest.raises(ValueError, match="does not cover this controller in closed loop"):
        native.chosen(box, start, False)
    monkeypatch.setenv("MICROCOSMOS_KERNEL", "fast")
    with pytest.raises(ValueError, match="one of auto, native, jax, got 'fast'"):
        native.chosen(box, start)


@pytest.mark.parametrize("value", ["", "fast"])
def test_a_variable_that_is_empty_is_unset_and_a_wrong_one_is_refused(value, tmp_path):
    """In processes of their own, which read it when they import the library."""
    given = os.environ | {"MICROCOSMOS_KERNEL": value}
    code = "from microcosmos import device; device.prepare(); print(device.kernel())"
    done = subprocess.run([sys.executable, "-c", code], env=given, capture_output=True)
    if not value:
        assert done.stdout == b"auto\n", done.stderr
        return
    wrong = "`MICROCOSMOS_KERNEL` must be one of auto, native, jax, got 'fast'\n"
    assert done.stderr.decode().endswith(f"ValueError: {wrong}")
    command = [sys.executable, "-m", "microcosmos", "evolve", "demo", "--out"]
    done = subprocess.run([*command, tmp_path / "a.h5"], env=given, capture_output=True)
    assert (done.returncode, done.stderr.decode()) == (2, wrong)


@pytest.mark.parametrize("set_before", ["", "--xla_b=0", "--xla_b_of_another=1"])
def test_flags_are_added_unless_one_of_them_is_set(monkeypatch, set_before):
    monkeypatch.setenv("XLA_FLAGS", set_before)
    device._add_flags("--xla_a=1 --xla_b=1")
    added = "" if set_before == "--xla_b=0" else "--xla_a=1 --xla_b=1"
    assert os.environ["XLA_FLAGS"] == f"{set_before} {added}".strip()


@pytest.mark.skipif(not device.portable_flags(), reason="not compared on this platform")
def test_the_device_kind_of_the_kernel_names_no_processor(monkeypatch):
    monkeypatch.setenv("XLA_FLAGS", str(device.portable_flags()))
    versions = (
        f"microcosmos {VERSION}, jax {jax.__version__}, jaxlib {jaxlib.version.__version__}"
    )
    alike = f"cpu, {versions}, microcosmos-kernels {kernels.__version__}"
    assert device.device_kind() == alike
    assert device.device_kind(portable=False) != alike
    monkeypatch.setenv("XLA_FLAGS", f"{device.portable_flags()} --xla_cpu_ftz=true")
    assert device.device_kind() == f"{alike}, --xla_cpu_ftz=true"
    monkeypatch.setenv("XLA_FLAGS", "")
    assert device.device_kind() not in (alike, "")
    monkeypatch.setenv("MICROCOSMOS_KERNEL", "jax")
    assert "kernels" not in device.device_kind()


@pytest.mark.parametrize("name", ["three bodies", "bodies that touch", "two layers"])
def test_threads_that_share_a_world_change_no_bit(name):
    box, start, rest = SCENES[name]()
    alone, shared = (
        run(partial(native.rollout, threads=threads), (box, start, rest)) for threads in (1, 3)
    )
    jax.tree.map(np.testing.assert_array_equal, shared, alone)


def test_steps_of_one_rest_shape_need_not_be_recorded():
    box, start, rest = SCENES["three bodies"]()
    still = jax.tree.map(lambda x: x[50], rest)
    end, seconds, held = native.advance(box, start, still, 20, threads=2)
    tiled = jax.tree.map(lambda x: jnp.tile(x, (20, 1)), still)
    jax.tree.map(np.testing.assert_array_equal, end, native.rollout(box, start, tiled)[0])
    assert 0 < float(seconds.sum()) < 60
    assert 9 * 4 * box.size[0] * box.size[1] < float(held) < 1e7
