"""Whole rollouts in the native kernel, `microcosmos-kernels`, through XLA's foreign functions.

The kernel takes the steps of `stepping` in the same order, but rounds in its own way: the same
on every CPU. It has no derivatives.
"""

import ctypes
import logging
from dataclasses import replace
from functools import cache
from importlib import import_module

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .. import coupling, device, filaments, fluid
from .model import Measures, State, World

LOG = logging.getLogger(__name__)
PARTS = (
    "windows",
    "moments",
    "interpolation",
    "constraints",
    "forcing",
    "spreading",
    "measures",
    "fluid",
)
"""Parts of a step, whose time `part_seconds` takes."""
OBSERVED = (
    "centre",
    "positions",
    "speed",
    "node_speed",
    "held",
    "heading",
    "curvature",
    "power",
    "force",
)
"""Measures in the order of the kernel's results."""
PROJECTIONS = (coupling.unprojected, coupling.force_free, coupling.torque_free)
DELTAS = (coupling.PESKIN, coupling.ROMA, coupling.HAT)


def chosen(world: World, state: State, open_loop: bool = True) -> bool:
    """Return whether the kernel simulates a world, see `device.kernel`.

    Raises `ValueError` where it has to and cannot.
    """
    installed = device.kernel_version() is not None
    reason = uncovered(world, state) if open_loop else "controllers in closed loop"
    if device.kernel() == "native" and (reason or not installed):
        lacking = (
            f"does not cover {reason}" if reason else "is not installed, or no CPU is used"
        )
        raise ValueError(f"`{device.KERNEL_VARIABLE}` is native, and the kernel {lacking}")
    if installed and reason:
        _say_once(reason)
    return installed and reason is None


@cache
def _say_once(reason: str) -> None:
    LOG.info("JAX simulates: the native kernel does not cover %s", reason)


@cache
def register(instruction_set: str | None = None) -> str:
    """Register the kernel with JAX, once, and return the name of its target."""
    path = import_module("microcosmos_kernels").library(instruction_set)
    target = f"microcosmos_rollout_{path.stem}"
    handler = jax.ffi.pycapsule(ctypes.CDLL(str(path)).microcosmos_rollout)
    jax.ffi.register_ffi_target(target, handler, platform="cpu")
    return target


def uncovered(world: World, state: State) -> str | None:
    """Return what of a world the kernel lacks; None if it can simulate the world."""
    lacking = {
        "a world without fluid": not world.form.fluid,
        "repulsion between nodes": world.steric is not None,
        "energy": world.energy is not None,
        "walls, a uniform force or a sponge": bool(jax.tree.leaves(world.surroundings)),
        "numbers other than float32": state.positions.dtype != jnp.float32,
        "a body without joints listed": world.rods.joints is None,
    }
    return next((reason for reason, holds in lacking.items() if holds), None)


def rollout(
    world: World,
    state: State,
    rest: filaments.Rest,
    instruction_set: str | None = None,
) -> tuple[State, Measures]:
    """Return the state after all steps of `rest` (time first), and the measures of each.

    The memory of the controller stays. Raises `ValueError` for a world the kernel lacks.
    """
    return _rollout(world, state, rest, instruction_set)[:2]


def part_seconds(world: World, state: State, rest: filaments.Rest) -> Float[Array, "part"]:
    """Return the time that a rollout spends in each of `PARTS`, in seconds."""
    return _rollout(world, state, rest, timed=True)[2]


def _rollout(
    world: World,
    state: State,
    rest: filaments.Rest,
    instruction_set: str | None = None,
    timed: bool = False,
) -> tuple[State, Measures, Float[Array, "part"]]:
    reason = uncovered(world, state)
    if reason:
        raise ValueError(f"the native kernel does not cover {reason}")
    steps, nodes, form = len(rest.angle), len(state.positions), world.form
    call = jax.ffi.ffi_call(
        register(instruction_set),
        [jax.ShapeDtypeStruct(shape, jnp.float32) for shape in _results(world, nodes, steps)],
        vmap_method="expand_dims",
    )
    found = call(
        *state.populations,
        state.positions,
        state.angles,
        rest.angle,
        rest.length,
        _parameters(world),
        *_graph(world, nodes),
        *_layout(world),
        *_stiffness(world, nodes),
        iterations=np.int32(form.forcing_iterations),
        sweeps=np.int32(form.constraint_iterations),
        layers=np.int32(form.layers),
        projection=np.int32(PROJECTIONS.index(form.projection)),
        delta=np.int32(DELTAS.index(form.kernel)),
        matched=np.int32(world.layout is not None),
        timed=np.int32(timed),
        bodies=np.int32(world.groups.count),
        force_factor=np.float32(form.force_factor),
        theta_feedback=np.float32(form.theta_feedback),
    )
    end = replace(state, populations=tuple(found[:9]), positions=found[9], angles=found[10])
    observed = dict(zip(OBSERVED, found[11:-1], strict=True))
    measures = jax.vmap(lambda rest, step: Measures(rest=rest, **step))(rest, observed)
    return end, measures, found[-1]


def _results(world: World, nodes: int, steps: int) -> list[tuple[int, ...]]:
    """Return the shapes of the end, of `OBSERVED` and of the time of each part."""
    edges, joints, bodies = len(world.rods.edges), len(world.rods.bend), world.groups.count
    end = [world.size] * 9 + [(nodes, 2), (edges,)]
    numbers = [(steps,)] * 4
    observed = [(steps, 2), (steps, nodes, 2), *numbers, (steps, joints), (steps,)]
    return [*end, *observed, (steps, bodies, 2), (len(PARTS),)]


def _parameters(world: World) -> Array:
    rates, limits = fluid.rates(world.viscosity, world.form.magic), world.limits
    bounds = [jnp.inf if one is None else one for one in (limits.displacement, limits.force)]
    lengths = coupling.step_lengths(world.form.forcing_iterations)
    return jnp.asarray([rates.even, rates.odd, *bounds, *lengths], jnp.float32)


def _graph(world: World, nodes: int) -> list[Array]:
    pieces = world.groups.member if world.layout is None else world.layout.pieces.member
    present = jnp.ones(nodes, bool) if world.present is None else world.present
    assert world.rods.joints is not None
    graph = (world.rods.edges, world.rods.joints, world.groups.member, pieces, present)
    return [jnp.asarray(one, jnp.int32) for one in graph]


def _layout(world: World) -> list[Array]:
    if world.layout is None:
        return [jnp.zeros((1,) * axes, jnp.float32) for axes in (1, 1, 2, 2)]
    one = world.layout
    return [
        jnp.asarray(x, jnp.float32) for x in (one.angle, one.rest_angle, one.turned, one.placed)
    ]


def _stiffness(world: World, nodes: int) -> list[Array]:
    rods = world.rods
    bend = rods.bend
    if world.nu_c is not None:
        bend = bend / (1 + world.viscosity / world.nu_c)
    # Colours may be those of the first of several chunks of equal bodies.
    chunk = len(rods.edge_colours[0].partner)
    colours = [
        _colours(pairings, len(stiffness) * chunk // nodes, len(stiffness))
        for pairings, stiffness in (
            (rods.edge_colours, rods.stretch),
            (rods.joint_colours, bend),
        )
    ]
    return [*colours, rods.stretch, rods.shear, bend]


def _colours(
    colours: tuple[filaments.Pairing, ...], chunk: int, count: int
) -> Int[Array, "constraint"]:
    """Return the colour of each constraint."""
    found = jnp.zeros(chunk, jnp.int32)
    for number, one in enumerate(colours):
        at = jnp.where(one.sign > 0, one.constraint, chunk)
        found = found.at[at].set(number, mode="drop")
    return jnp.tile(found, -(-count // max(chunk, 1)))[:count]
