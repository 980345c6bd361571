"""Development and whole rollouts in the native kernel, through XLA's foreign functions.

The kernel, `microcosmos-kernels`, takes the steps of `stepping` in the same order, but rounds
in its own way: the same on every CPU. It has no derivatives.
"""

import ctypes
import logging
from collections.abc import Collection, Mapping, Sequence
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
    living_of,
    rations_of,
    slots_of,
    smoothing_of,
    state_of,
    stiffness_of,
    surroundings_of,
)
from .slots import Living, Slots, Tally, check_window, flat_state, intake

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
"""Parts of a step whose times the kernel measures, in the order of its enumeration."""
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
    "boxes",
)
"""Measures in the order of the kernel's results."""
WHOLE = {12, 18, 19, 20}
"""Places of whole numbers among the results of `live`: ages, food, accounts, time."""
TALLY = 10
"""Numbers of a slot's measures."""
ALONE: Numbers = {"threads": 1, "observed": True, "timed": False}
"""Default options of a rollout: one thread, measures of each step, no times of the parts."""
# Places in these tuples are the kernel's numbers of a choice, see `rollout.h`.
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


@cache  # The log names each reason once a process, not once a program.
def _say_once(reason: str) -> None:
    LOG.info("JAX simulates: the native kernel does not cover %s", reason)


@cache
def register(function: str, instruction_set: str | None = None) -> str:
    """Register a function of the kernel with JAX, once, and return the name of its target."""
    path = import_module("microcosmos_kernels").library(instruction_set)
    # One target for each instruction set, since tests load several into one process.
    target = f"microcosmos_{function}_{path.stem}"
    handler = jax.ffi.pycapsule(getattr(ctypes.CDLL(str(path)), f"microcosmos_{function}"))
    jax.ffi.register_ffi_target(target, handler, platform="cpu")
    return target


def uncovered(world: World, state: State) -> str | None:
    """Return the feature that the kernel lacks for a world; None if it simulates the world."""
    form = world.form
    lacking = {
        "forcing of another projection": form.projection not in PROJECTIONS,
        "another delta": form.kernel not in DELTAS,
        "another magic parameter": form.magic not in MAGIC,
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
    """Return rest shapes for all times, and the controller's time at the end of each step.

    The controller commands them in open loop; its actuators have carried them out.
    """
    steps, rods = len(controller.ramp), world.rods
    shapes = [(steps, len(rods.bend)), (steps, len(rods.edges)), (steps,)]
    angle, length, clock = call(
        register("develop", instruction_set),
        shapes,
        *development_operands(world, state, controller),
    )
    return filaments.Rest(angle, length), clock


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
    """Return the state after all steps, and the measures of each step (time first).

    `given` are rest shapes (time first), or a controller in closed loop, whose memory the state
    keeps. `threads` share the world; results do not depend on their number. Raises `ValueError`
    for a world that the kernel does not cover.
    """
    end, results = _rollout(world, state, given, instruction_set, {"threads": threads})
    rest = filaments.Rest(*results[:2]) if isinstance(given, Controller) else given
    observed = dict(zip(OBSERVED, results[2:-2], strict=True))
    measures = jax.vmap(lambda rest, step: Measures(rest=rest, **step))(rest, observed)
    return end, measures


def advance(
    world: World, state: State, rest: filaments.Rest, steps: int, threads: int = 1
) -> tuple[State, Float[Array, "part"], Float[Array, ""]]:
    """Return the state after `steps` of one rest shape, without a record of them.

    Also return the time spent in each of `PARTS`, in seconds, and the bytes of the kernel's
    arrays, those of worlds that other threads simulate at the same time included.
    """
    still = jax.tree.map(lambda x: x[None], rest)
    options = {"steps": steps, "threads": threads, "observed": False, "timed": True}
    end, results = _rollout(world, state, still, None, options)
    return end, results[-2], results[-1][0]


def live(
    place: World,
    slots: Slots,
    living: Living,
    steps: int,
    every: int = 1,
    instruction_set: str | None = None,
    threads: int = 1,
) -> tuple[Living, Tally]:
    """Return the state after a window of steps, and the measures of each slot, as
    `genomes.living.live`. Raises `ValueError` for a world that the kernel does not cover.
    """
    return _live(place, slots, living, steps, every, instruction_set, {"threads": threads})[:2]


def part_seconds_of_slots(
    place: World, slots: Slots, living: Living, steps: int, every: int = 1, threads: int = 1
) -> tuple[Living, Tally, Float[Array, "part"]]:
    """Return the state after a window, the measures of each slot, and the time spent in each
    of `PARTS`, in seconds."""
    return _live(place, slots, living, steps, every, None, {"timed": True, "threads": threads})


def _live(
    place: World,
    slots: Slots,
    living: Living,
    steps: int,
    every: int,
    instruction_set: str | None,
    chosen: Numbers,
) -> tuple[Living, Tally, Float[Array, "part"]]:
    check_window(place, living, steps, every)
    reason = uncovered(place, flat_state(living))
    if reason:
        raise ValueError(f"the native kernel does not cover {reason}")
    state, shapes = state_of(living, slots.occupants.network.bias.shape[1])
    held, numbers = slots_of(place, slots)
    around, features = surroundings_of(place)
    food, eating = rations_of(place)
    operands = [*state, *held, _parameters(place), *food, *smoothing_of(place), *around]
    options = {**features, **eating, **_form(place), **numbers, **ALONE, **chosen}
    options |= {"steps": steps, "every": every, "energetic": living.energy is not None}
    count, rows = len(slots.filled), 0 if place.food is None else place.size[0]
    results = call(
        register("live", instruction_set),
        [*shapes, (count, TALLY), (rows, 2), (rows, 2), (len(PARTS),), (1,)],
        operands,
        options,
        whole={*WHOLE, len(shapes) + 1, len(shapes) + 2},
    )
    *ends, tally, grown, lost, seconds, _ = results
    after = living_of(living, ends)
    measures = Tally(
        tally[:, :2],
        *(tally[:, n] for n in range(2, TALLY)),
        intake=intake(living, after),
        grown=grown if rows else None,
        lost=lost if rows else None,
    )
    return after, measures, seconds


def part_seconds(
    world: World, state: State, rest: filaments.Rest, threads: int = 1
) -> Float[Array, "part"]:
    """Return the time that a rollout spends in each of `PARTS`, in seconds."""
    return _rollout(world, state, rest, None, {"timed": True, "threads": threads})[1][-2]


def _rollout(
    world: World,
    state: State,
    given: filaments.Rest | Controller,
    instruction_set: str | None,
    chosen: Numbers,
) -> tuple[State, list[Array]]:
    """Return the end; rest shapes of a controller, `OBSERVED`, times and bytes in one list."""
    reason = uncovered(world, state)
    if reason:
        raise ValueError(f"the native kernel does not cover {reason}")
    closed = isinstance(given, Controller)
    operands, numbers = rollout_operands(world, state, given)
    options = {**numbers, **chosen}
    shapes = _results(world, state, options["steps"] if options["observed"] else 0, closed)
    results = call(register("rollout", instruction_set), shapes, operands, options)
    end = replace(
        state,
        populations=tuple(results[:9]),
        positions=results[9],
        angles=results[10],
        boxes=results[11],
    )
    if state.energy is not None:
        end = replace(end, energy=results[12], collected=results[13])
    return end, results[14:]


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
    # The interface has a fixed list of operands: what is absent has no items.
    nothing = jnp.zeros((0, joints), jnp.float32), jnp.zeros((0, edges), jnp.float32)
    rest = nothing if isinstance(given, Controller) else (given.angle, given.length)
    field = jnp.zeros((0, world.size[1]), jnp.float32) if state.energy is None else state.energy
    operands = [
        *state.populations,
        *body,
        *stiffness_of(world),
        _parameters(world),
        state.boxes,
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
        "repelled": world.steric is not None or world.contact is not None,
        "paired": world.contact is not None,
        "soft": world.layout is not None and world.layout.bend is not None,
    }


def call(
    target: str,
    shapes: Sequence[tuple[int, ...]],
    operands: Sequence[Array],
    options: Mapping[str, int],
    whole: Collection[int] = (),
) -> list[Array]:
    """Return the results of these shapes of a registered function: float32, or int32 at the
    places in `whole`.

    `shapes` and `operands` are those of one world; under `vmap` batch axes come first.
    """
    function = jax.ffi.ffi_call(
        target,
        [
            jax.ShapeDtypeStruct(shape, jnp.int32 if place in whole else jnp.float32)
            for place, shape in enumerate(shapes)
        ],
        # An operand that all worlds of a batch share gets an axis of length 1, not copies.
        vmap_method="expand_dims",
    )
    # The type of an attribute is that of its scalar, and the kernel reads 32 bits.
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
    """Return the shapes of the kernel's results: end, rest shapes, `OBSERVED`, times, bytes."""
    joints, edges = _counts(world)
    nodes, bodies = len(state.positions), world.groups.count
    energetic, commanded = state.energy is not None, steps if closed else 0
    end = [world.size] * 9 + [(nodes, 2), (edges,), (bodies, 2)]
    end += [(world.size[0] * energetic, world.size[1]), (nodes * energetic,)]
    rest = [(commanded, joints), (commanded, edges)]
    numbers = [(steps,)] * 4
    observed = [(steps, 2), (steps, nodes, 2), *numbers, (steps, joints), (steps,)]
    return [*end, *rest, *observed, *[(steps, bodies, 2)] * 2, (len(PARTS),), (1,)]


def _parameters(world: World) -> Array:
    form, limits, energy = world.form, world.limits, world.energy
    # The kernel's parameters have a fixed length: what is absent has a value without effect.
    bounds = [
        jnp.inf if one is None else one
        for one in (world.nu_c, limits.displacement, limits.force)
    ]
    # A rate of 0 takes nothing; without one energy is counted and stays.
    rate = -1.0 if energy is None or energy.rate is None else energy.rate
    diffusion = 0.0 if energy is None or energy.diffusion is None else energy.diffusion
    steric = world.steric if world.contact is None else world.contact
    repulsion = (0.0, 0.0) if steric is None else (steric.strength, steric.limit)
    barred = 0.0 if world.barrier is None else world.barrier.limit
    factors = (form.force_factor, form.theta_feedback)
    values = [world.viscosity, bounds[0], rate, diffusion, *bounds[1:], *factors, *repulsion]
    lengths = coupling.step_lengths(form.forcing_iterations)
    return jnp.stack([jnp.asarray(one, jnp.float32) for one in (*values, barred, *lengths)])
