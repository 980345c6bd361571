"""Inputs of the native kernel's calls that evaluate one creature, for a kernel elsewhere."""

from collections.abc import Mapping
from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ..filaments import Rest
from ..world import native
from .evaluation import form_of, in_trials, length_of
from .simulation import clock_of, drive, given_of, schooled, shift_energy, turned
from .task import Actuator, Task
from .window import whole_units

Numbers = tuple[tuple[str, int], ...]


class NotCovered(ValueError):
    """The native kernel does not carry out this creature."""

    def __init__(self, reason: str):
        super().__init__(f"the native kernel does not cover {reason}")
        self.reason = reason


class Inputs(eqx.Module):
    """Operands of the calls that simulate and measure one creature, in the kernel's order.

    Axes of trials and placements come first, whether or not the task has several of them.
    """

    develop: tuple[Array, ...]
    """Empty for a creature whose rest shapes are given or follow what it senses."""
    rollout: tuple[Array, ...]
    """Rest shapes are empty with a development, which computes them."""
    clock: Float[Array, "*several time"]
    """The controller's time at the end of each step; with a development it is a result."""
    scales: Float[Array, "*several 3"]
    """Viscosity, length of the body in cells, steps in a stroke or 0."""
    whole: Int[Array, "*several node 2"]
    """Positions of nodes at the start in whole units, for the measure `crossing`."""
    constant: dict[str, Array]
    """Measures that no simulation changes, by name."""
    development: Numbers = eqx.field(static=True)
    """Numbers of the call `develop`; none without a development."""
    simulation: Numbers = eqx.field(static=True)
    """Numbers of the call `rollout`, which has those of `summarise`."""


def inputs(task: Task, actuator: Actuator) -> Inputs:
    """Return the inputs of all simulations in which `evaluate` measures an actuator.

    Raises `NotCovered` where JAX has to simulate.
    """
    if task.trials > 1:
        return in_trials(task, lambda one: _placed(one, actuator))
    return jax.tree.map(lambda x: x[None], _placed(task, actuator))


def _placed(task: Task, actuator: Actuator) -> Inputs:
    if task.placements is None:
        return jax.tree.map(lambda x: x[None], _simulation(task, actuator, None))
    return jax.lax.map(lambda shift: _simulation(task, actuator, shift), task.placements)


def _simulation(task: Task, actuator: Actuator, shift: Int[Array, "2"] | None) -> Inputs:
    # The controller and not what it commands: the other kernel develops that.
    alone = drive(replace(task, turn=None, places=None), actuator, differentiable=True)
    controller = alone.controller
    develop, development = [], {}
    if controller is not None and not controller.senses:
        develop, development = native.development_operands(alone.world, alone.start, controller)
    driven = alone
    if task.turn is not None:
        driven = replace(driven, start=turned(driven.start, task.turn))
    if task.places is not None:
        driven = schooled(driven, task.places)
    if shift is not None:
        driven = shift_energy(driven, shift)
    given = given_of(driven)
    reason = native.uncovered(driven.world, driven.start)
    if reason or given is None:
        raise NotCovered(reason or "this controller in closed loop")
    if development:
        nothing = jnp.zeros((development["steps"], 0), jnp.float32)
        given = Rest(nothing, nothing)
    rollout, simulation = native.rollout_operands(driven.world, driven.start, given)
    scales = [driven.world.viscosity, length_of(task, alone), task.period or 0.0]
    return Inputs(
        develop=tuple(develop),
        rollout=tuple(rollout),
        clock=clock_of(driven, 0 if development else simulation["steps"]),
        scales=jnp.stack([jnp.asarray(one, jnp.float32) for one in scales]),
        whole=whole_units(driven.start.positions),
        constant={**size_of(task, actuator), **form_of(task, alone)},
        development=_fixed(development),
        simulation=_fixed(simulation),
    )


def size_of(task: Task, actuator: Actuator) -> dict[str, Array]:
    """Return the measures of a genome; rest shapes have none."""
    if task.encoding is None or isinstance(actuator, Rest):
        return {}
    hidden, connections = task.encoding.size(actuator)
    return {"hidden_nodes": hidden, "connections": connections}


def _fixed(numbers: Mapping[str, int]) -> Numbers:
    return tuple((name, int(value)) for name, value in numbers.items())
