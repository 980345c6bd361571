"""Simulation of an actuator: by the native kernel where it can, else by JAX."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ..filaments import Rest
from ..genomes import Drive, carried_out
from ..portable import cosine, sine
from ..world import Measures, State, follow, gpu, keep_memory, native, rollout
from .measures import observe
from .school import schooled
from .task import Actuator, Task


def shift_energy(driven: Drive, shift: Int[Array, "2"]) -> Drive:
    """Return the simulation with the energy moved by `shift` cells."""
    assert driven.start.energy is not None
    energy = jnp.roll(driven.start.energy, shift, (0, 1))
    return replace(driven, start=replace(driven.start, energy=energy))


def drive(task: Task, actuator: Actuator, *, differentiable: bool = False) -> Drive:
    """Return the simulation of a genotype, or of a body that follows rest shapes, and of all
    its copies.

    The native kernel develops what it can, unless the result has to be `differentiable`.
    """
    driven = _alone(task, actuator, differentiable)
    return driven if task.places is None else schooled(driven, task.places)


def _alone(task: Task, actuator: Actuator, differentiable: bool) -> Drive:
    if isinstance(actuator, Rest) or task.encoding is None:
        return Drive(task.world, task.start, actuator)
    driven = task.encoding.drive(task.world, task.start, actuator, task.phase)
    if task.actuators is not None:
        own = (
            task.actuators
            if driven.layout is None
            else replace(task.actuators, layout=driven.layout)
        )
        driven = carried_out(driven, own)
    if not differentiable:
        driven = _developed(driven)
    if task.turn is None:
        return driven
    return replace(driven, start=turned(driven.start, task.turn))


def _developed(driven: Drive) -> Drive:
    """Return the simulation with rest shapes of the native kernel, if it simulates that."""
    world, start, controller = driven.world, driven.start, driven.controller
    if controller is None or controller.senses or not native.chosen(world, start):
        return driven
    rest, clock = native.develop(world, start, controller)
    return replace(driven, inputs=rest, clock=clock)


def turned(state: State, turn: Float[Array, ""]) -> State:
    """Return the state with the bodies turned about the mean of all nodes, in rad."""
    c, s = cosine(turn), sine(turn)
    middle = jnp.mean(state.positions, 0)
    x, y = (state.positions - middle[None]).T
    positions = jnp.stack([c * x - s * y, s * x + c * y], 1) + middle[None]
    return replace(state, positions=positions, angles=state.angles + turn)


def simulate(
    driven: Drive,
    observer: Callable[[State, Measures], Any] = observe,
    segment: int | None = None,
    *,
    differentiable: bool = False,
) -> tuple[State, Any]:
    """Return the state at the end, and the observations after each step.

    A kernel simulates what it can, unless the result has to be `differentiable`.
    """
    plain = observer is observe and segment is None and not differentiable
    given = given_of(driven)
    if plain and is_native(driven):
        return native.rollout(driven.world, driven.start, given)
    if plain and isinstance(given, Rest) and gpu.chosen(driven.world, driven.start):
        return gpu.rollout(driven.world, driven.start, given)
    go_on = partial(rollout, control=driven.control, remember=driven.remember, segment=segment)
    return go_on(driven.world, driven.start, driven.inputs, observer)


def is_native(driven: Drive) -> bool:
    """Return whether the native kernel simulates this; see `native.chosen`."""
    return native.chosen(driven.world, driven.start, given_of(driven) is not None)


def given_of(driven: Drive) -> Any:
    """Return rest shapes, or in closed loop the controller; None if only JAX knows it."""
    open_loop = driven.control is follow and driven.remember is keep_memory
    return driven.inputs if open_loop else driven.controller


def strokes(driven: Drive, period: float | None, steps: int) -> Float[Array, "time"]:
    """Return the strokes done at the end of each of the first steps; 0 without a period."""
    clock = clock_of(driven, steps)
    return jnp.zeros_like(clock) if period is None else clock / period


def clock_of(driven: Drive, steps: int) -> Float[Array, "time"]:
    """Return the controller's time at the end of each of the first steps."""
    return jnp.arange(1.0, steps + 1) if driven.clock is None else driven.clock[:steps]
