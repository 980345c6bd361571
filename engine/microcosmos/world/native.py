"""Development and whole rollouts in the native kernel, through XLA's foreign functions.

The kernel, `microcosmos-kernels`, takes the steps of `stepping` in the same order, but rounds
in its own way: the same on every CPU. It has no derivatives.
"""

import ctypes
import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib import import_module

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .. import coupling, device, fields, filaments, fluid
from .controller import Controller
from .model import Measures, State, World
from .operands import (
    Numbers,
    body_of,
    controller_of,
    smoothing_of,
    stiffness_of,
    surroundings_of,
)

LOG = logging.getLogger(__name__)
PARTS = (
    "control",
    "repulsion",
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
ALONE: Numbers = {"threads": 1, "observed": True, "timed": False}
"""How a rollout is carried out, unless something else is chosen."""
PROJECTIONS = (coupling.unprojected, coupling.force_free, coupling.torque_free)
DELTAS = (coupling.PESKIN, coupling.ROMA, coupling.HAT)
MAGIC = (fluid.capped_magic, fluid.fixed_magic)


def chosen(world: World, state: State, covered: bool = True) -> bool:
    """Return whether the kernel simulates a world, see `device.kernel`.

    `covered` is false for a controller that the kernel lacks. Raises `ValueError` where the
    kernel has to simulate and cannot.
    """
    installed = device.kernel_version() is not None
    reason = uncovered(world, state) if covered else "this controller in closed loop"
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
def register(function: str, instruction_set: str | None = None) -> str:
    """Register a function of the kernel with JAX, once, and return the name of its target."""
    path = import_module("microcosmos_kernels").library(instruction_set)
    target = f"microcosmos_{function}_{path.stem}"
    handler = jax.ffi.pycapsule(getattr(ctypes.CDLL(str(path)), f"microcosmos_{function}"))
    jax.ffi.register_ffi_target(target, handler, platform="cpu")
    return target


def uncovered(world: World, state: State) -> str | None:
    """Return what of a world the kernel lacks; None if it can simulate the world."""
    lacking = {
        "repulsion of another form": not _known_repulsion(world),
        "numbers other than float32": state.positions.dtype != jnp.float32,
        "a body without joints listed": world.rods.joints is None,
    }
    return next((reason for reason, holds in lacking.items() if holds), None)


def _known_repulsion(world: World) -> bool:
    return world.steric is None or world.steric.gradient in fields.WEIGHTS


def develop(
    world: World, state: State, controller: Controller, instruction_set: str | None = None
) -> tuple[filaments.Rest, Float[Array, "time"]]:
    """Return the rest shapes at all times that a controller commands in open loop and its
    actuators carry out, and the controller's time at the end of each step."""
    steps, rods = len(controller.ramp), world.rods
    shapes = [(steps, len(rods.bend)), (steps, len(rods.edges)), (steps,)]
    found = call(
        register("develop", instruction_set),
        shapes,
        *development_operands(world, state, controller),
    )
    return filaments.Rest(found[0], found[1]), found[2]


def development_operands(
    world: World, state: State, controller: Controller
) -> tuple[list[Array], Numbers]:
    """Return the operands of a development, in the kernel's order, and its numbers."""
    body, sizes = body_of(world, state, controller)
    commands, numbers = controller_of(controller)
    return [*body, *commands], {**sizes, **numbers, "steps": len(controller.ramp)}


def rollout(
    world: World,
    state: State,
    given: filaments.Rest | Controller,
    instruction_set: str | None = None,
    threads: int = 1,
) -> tuple[State, Measures]:
    """Return the state after all steps of rest shapes (time first), or of a controller in
    closed loop, and the measures of each step.

    The memory of the controller stays. `threads` share the world; results do not depend on
    them. Raises `ValueError` for a world the kernel lacks.
    """
    end, found = _rollout(world, state, given, instruction_set, {"threads": threads})
    rest = filaments.Rest(*found[:2]) if isinstance(given, Controller) else given
    observed = dict(zip(OBSERVED, found[2:-2], strict=True))
    measures = jax.vmap(lambda rest, step: Measures(rest=rest, **step))(rest, observed)
    return end, measures


def advance(
    world: World, state: State, rest: filaments.Rest, steps: int, threads: int = 1
) -> tuple[State, Float[Array, "part"], Float[Array, ""]]:
    """Return the state after some steps of one rest shape, nothing of which is recorded, the
    time that they spent in each of `PARTS`, in seconds, and the bytes of the kernel's arrays.

    Worlds that other threads simulate at the same time count too.
    """
    still = jax.tree.map(lambda x: x[None], rest)
    options = {"steps": steps, "threads": threads, "observed": False, "timed": True}
    end, found = _rollout(world, state, still, None, options)
    return end, found[-2], found[-1][0]


def part_seconds(world: World, state: State, rest: filaments.Rest) -> Float[Array, "part"]:
    """Return the time that a rollout spends in each of `PARTS`, in seconds."""
    return _rollout(world, state, rest, None, {"timed": True})[1][-2]


def _rollout(
    world: World,
    state: State,
    given: filaments.Rest | Controller,
    instruction_set: str | None,
    chosen: Numbers,
) -> tuple[State, list[Array]]:
    """Return the end, then rest shapes of a controller, `OBSERVED`, times and bytes."""
    reason = uncovered(world, state)
    if reason:
        raise ValueError(f"the native kernel does not cover {reason}")
    closed = isinstance(given, Controller)
    operands, numbers = rollout_operands(world, state, given)
    options = {**numbers, **chosen}
    shapes = _results(world, state, options["steps"] if options["observed"] else 0, closed)
    found = call(register("rollout", instruction_set), shapes, operands, options)
    end = replace(state, populations=tuple(found[:9]), positions=found[9], angles=found[10])
    if state.energy is not None:
        end = replace(end, energy=found[11], collected=found[12])
    return end, found[13:]


def rollout_operands(
    world: World, state: State, given: filaments.Rest | Controller
) -> tuple[list[Array], Numbers]:
    """Return the operands of a rollout, in the kernel's order, and its numbers."""
    controller = given if isinstance(given, Controller) else None
    steps = len(given.ramp) if isinstance(given, Controller) else len(given.angle)
    body, sizes = body_of(world, state, controller)
    commands, numbers = controller_of(controller)
    around, features = surroundings_of(world)
    joints, edges = _counts(world)
    nothing = jnp.zeros((0, joints), jnp.float32), jnp.zeros((0, edges), jnp.float32)
    rest = nothing if isinstance(given, Controller) else (given.angle, given.length)
    field = jnp.zeros((0, world.size[1]), jnp.float32) if state.energy is None else state.energy
    operands = [
        *state.populations,
        *body,
        *stiffness_of(world),
        _parameters(world),
        field,
        _collected(state),
        *smoothing_of(world),
        *around,
        *rest,
        *commands,
    ]
    options = {**sizes, **numbers, **features, **_form(world), **ALONE}
    return operands, {**options, "steps": steps, "energetic": state.energy is not None}


def _form(world: World) -> dict[str, int]:
    form = world.form
    return {
        "height": world.size[0],
        "width": world.size[1],
        "iterations": form.forcing_iterations,
        "sweeps": form.constraint_iterations,
        "layers": form.layers,
        "projection": PROJECTIONS.index(form.projection),
        "delta": DELTAS.index(form.kernel),
        "magic": MAGIC.index(form.magic),
        "fluid": form.fluid,
        "repelled": world.steric is not None,
        "soft": world.layout is not None and world.layout.bend is not None,
    }


def call(
    target: str,
    shapes: Sequence[tuple[int, ...]],
    operands: Sequence[Array],
    options: Mapping[str, int],
) -> list[Array]:
    """Return the results, of these shapes, of a registered function."""
    function = jax.ffi.ffi_call(
        target,
        [jax.ShapeDtypeStruct(shape, jnp.float32) for shape in shapes],
        vmap_method="expand_dims",
    )
    return list(
        function(*operands, **{name: np.int32(value) for name, value in options.items()})
    )


def _counts(world: World) -> tuple[int, int]:
    return len(world.rods.bend), len(world.rods.edges)


def _collected(state: State) -> Float[Array, "node"]:
    if state.energy is None:
        return jnp.zeros(0, jnp.float32)
    if state.collected is None:
        return jnp.zeros(len(state.positions), jnp.float32)
    return state.collected


def _results(world: World, state: State, steps: int, closed: bool) -> list[tuple[int, ...]]:
    """Return the shapes of the end, of rest shapes, of `OBSERVED`, of times and of bytes."""
    joints, edges = _counts(world)
    nodes, bodies = len(state.positions), world.groups.count
    energetic, commanded = state.energy is not None, steps if closed else 0
    end = [world.size] * 9 + [(nodes, 2), (edges,)]
    end += [(world.size[0] * energetic, world.size[1]), (nodes * energetic,)]
    rest = [(commanded, joints), (commanded, edges)]
    numbers = [(steps,)] * 4
    observed = [(steps, 2), (steps, nodes, 2), *numbers, (steps, joints), (steps,)]
    return [*end, *rest, *observed, (steps, bodies, 2), (len(PARTS),), (1,)]


def _parameters(world: World) -> Array:
    form, limits, energy = world.form, world.limits, world.energy
    bounds = [jnp.inf if one is None else one for one in (limits.displacement, limits.force)]
    rate, diffusion = (None, None) if energy is None else (energy.rate, energy.diffusion)
    absent = [0.0 if one is None else one for one in (world.nu_c, rate, diffusion)]
    steric = world.steric
    repulsion = (0.0, 0.0) if steric is None else (steric.strength, steric.limit)
    barred = 0.0 if world.barrier is None else world.barrier.limit
    factors = (form.force_factor, form.theta_feedback)
    values = [world.viscosity, *absent, *bounds, *factors, *repulsion, barred]
    lengths = coupling.step_lengths(form.forcing_iterations)
    return jnp.stack([jnp.asarray(one, jnp.float32) for one in (*values, *lengths)])
