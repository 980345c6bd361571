"""Evaluation of one creature: from its genome to fitness, descriptors and measures."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .. import units
from ..filaments import Rest
from ..genomes import Actuators, Drive, Encoding, Genotype, carried_out
from ..world import Measures, State, World, centre, flow, follow, keep_memory, native, rollout
from .kinematics import kinematics
from .measures import (
    MEASURES,
    Measure,
    cost_of_transport,
    motion,
    motion_for_plugins,
    observe,
    swimming,
)
from .window import Poses, poses, window

STATUSES = ("ok", "non-finite", "supersonic", "limits", "compressible", "impulse")
"""Outcome of an evaluation by status code: feasible, or the reason why not.

The last three are found by `judged`.
"""

Scalar = Float[Array, ""]

Actuator = Genotype | Rest
"""A genotype, or rest shapes over time."""


class Evaluation(eqx.Module):
    """The result for one creature, or for a block of them."""

    fitness: Float[Array, "*block"]
    measures: Float[Array, "*block measure"]
    status: Int[Array, "*block"]
    poses: Poses | None = None


class Goal(eqx.Module):
    """Weights of displacement and collected energy in fitness."""

    displacement: float = eqx.field(static=True, default=1.0)
    energy: float = eqx.field(static=True, default=0.0)
    measure: str | None = eqx.field(static=True, default=None)
    """Name of the measure that replaces both terms; None: displacement and energy."""
    sign: float = eqx.field(static=True, default=1.0)
    """−1: the smaller the measure, the fitter the creature."""


class Task(eqx.Module):
    """A world with a body at its start, the encoding of genotypes, and the goal."""

    world: World
    start: State
    encoding: Encoding | None = eqx.field(static=True, default=None)
    goal: Goal = Goal()
    length: float = eqx.field(static=True, default=1.0)
    """Length of the body in cells, for the Reynolds number."""
    period: float | None = eqx.field(static=True, default=None)
    """Steps of the controller's clock in a stroke; None: it has no strokes."""
    phase: Float[Array, ""] | None = None
    """Lead of a periodic timer, in rad."""
    turn: Float[Array, ""] | None = None
    """Turn of the body about its middle at the start, in rad."""
    trials: int = eqx.field(static=True, default=1)
    """Simulations of each creature, which differ in heading and phase."""
    placements: Int[Array, "placement 2"] | None = None
    """Shift of the energy, in cells, in each world that a creature is measured in; None: one
    world, unshifted."""
    actuators: Actuators | None = None
    """Bounds on what the controllers of genotypes command; None: none."""
    plugin_measures: tuple[Measure, ...] = eqx.field(static=True, default=())
    """Measures of plug-ins, beside the usual ones."""

    @property
    def measures(self) -> tuple[str, ...]:
        """Names of the measures of every creature, in this order."""
        return MEASURES + tuple(measure.name for measure in self.plugin_measures)


def evaluate(task: Task, genotype: Genotype) -> Evaluation:
    """Simulate one creature in all trials and measure it.

    Returns the mean fitness and measures; `trial_spread` is the standard deviation of fitness.
    The largest values of `FEASIBLE` count, and the first trial's poses are kept.
    """
    if task.trials == 1:
        return evaluate_drive(task, genotype, drive(task, genotype))

    found = in_trials(task, lambda one: evaluate_drive(one, genotype, drive(one, genotype)))
    measures = jnp.mean(found.measures, 0)
    for name, _ in FEASIBLE.values():
        at = MEASURES.index(name)
        measures = measures.at[at].set(jnp.max(found.measures[:, at]))
    measures = measures.at[MEASURES.index("trial_spread")].set(jnp.std(found.fitness, ddof=1))
    first = jax.tree.map(lambda x: x[0], found.poses)
    return Evaluation(jnp.mean(found.fitness), measures, jnp.max(found.status), first)


Result = TypeVar("Result")


def in_trials(task: Task, function: Callable[[Task], Result]) -> Result:
    """Apply a function to the task of every trial; results have the trial as first axis."""
    numbers = jnp.arange(task.trials)
    return jax.lax.map(lambda number: function(trial(task, number)), numbers)


def trial(task: Task, number: Int[Array, ""]) -> Task:
    """Return the task of one trial: 45° more of heading and a share of a stroke more of phase
    than in the trial before."""
    dtype = task.start.positions.dtype
    number = number.astype(dtype)
    phase = 2 * jnp.pi * number / task.trials
    return replace(task, phase=phase, turn=jnp.pi / 4 * number, trials=1)


def evaluate_drive(task: Task, genotype: Genotype, driven: Drive) -> Evaluation:
    """Simulate and measure a developed genotype; return means over all placements."""
    if task.placements is None:
        return _evaluate(task, genotype, driven)
    found = jax.lax.map(
        lambda shift: _evaluate(task, genotype, shift_energy(driven, shift)), task.placements
    )
    means = jnp.mean(found.fitness), jnp.mean(found.measures, 0)
    return Evaluation(*means, jnp.max(found.status), jax.tree.map(lambda x: x[0], found.poses))


def shift_energy(driven: Drive, shift: Int[Array, "2"]) -> Drive:
    """Return the simulation with the energy moved by `shift` cells."""
    assert driven.start.energy is not None
    energy = jnp.roll(driven.start.energy, shift, (0, 1))
    return replace(driven, start=replace(driven.start, energy=energy))


def _evaluate(task: Task, genotype: Genotype, driven: Drive) -> Evaluation:
    if task.encoding is None:
        raise ValueError("`task.encoding` must say what the genotype means; got None.")
    end, observed = simulate(driven)
    values = motion_of(task, driven, end, observed)
    values["hidden_nodes"], values["connections"] = task.encoding.size(genotype)
    dtype = observed.centre.dtype
    measures = jnp.stack([values[name].astype(dtype) for name in task.measures])
    fitness = fitness_of(task, values)
    valid = status(driven.world, end, measures)
    shown = poses_of(task, driven, observed)
    return Evaluation(fitness.astype(dtype), measures, valid, shown)


def drive(task: Task, actuator: Actuator, *, differentiable: bool = False) -> Drive:
    """Return the simulation of a genotype, or of a body that follows rest shapes.

    The native kernel develops what it can, unless the result has to be `differentiable`.
    """
    if isinstance(actuator, Rest) or task.encoding is None:
        return Drive(task.world, task.start, actuator)
    driven = task.encoding.drive(task.world, task.start, actuator, task.phase)
    driven = driven if task.actuators is None else carried_out(driven, task.actuators)
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


def turned(state: State, turn: Scalar) -> State:
    """Return the state with the bodies turned about the mean of all nodes, in rad."""
    c, s = jnp.cos(turn), jnp.sin(turn)
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

    The native kernel simulates what it can, unless the result has to be `differentiable`.
    """
    open_loop = driven.control is follow and driven.remember is keep_memory
    given: Any = driven.inputs if open_loop else driven.controller
    plain = observer is observe and segment is None and not differentiable
    if plain and native.chosen(driven.world, driven.start, given is not None):
        return native.rollout(driven.world, driven.start, given)
    go_on = partial(rollout, control=driven.control, remember=driven.remember, segment=segment)
    return go_on(driven.world, driven.start, driven.inputs, observer)


def motion_of(task: Task, driven: Drive, end: State, observed: Measures) -> dict[str, Any]:
    """Return measures of any actuator's motion."""
    length = task.length if driven.length is None else driven.length
    values = motion(driven.world, driven.start, end, observed, length)
    done = strokes(driven, task.period, len(observed.centre))
    values["speed"], values["stride"] = swimming(observed.centre, done, length)
    values["cost_of_transport"] = cost_of_transport(
        centre(driven.world, driven.start), observed, done, length
    )
    values |= kinematics(driven.world, observed, window(done), length)
    values["trial_spread"] = jnp.zeros_like(values["speed"])
    if not task.plugin_measures:
        return values
    whole = motion_for_plugins(driven.world, driven.start, end, observed, values)
    return values | {measure.name: measure.of(whole) for measure in task.plugin_measures}


def poses_of(task: Task, driven: Drive, observed: Measures) -> Poses:
    """Return the pose stream of a simulation."""
    length = task.length if driven.length is None else driven.length
    last = window(strokes(driven, task.period, len(observed.centre)))
    begun, present = centre(driven.world, driven.start), driven.world.present
    return poses(begun, observed.centre, observed.positions, present, last, length)


def strokes(driven: Drive, period: float | None, steps: int) -> Float[Array, "time"]:
    """Return the strokes done at the end of each of the first steps; 0 without a period."""
    clock = jnp.arange(1.0, steps + 1) if driven.clock is None else driven.clock[:steps]
    return jnp.zeros_like(clock) if period is None else clock / period


def fitness_of(task: Task, values: Mapping[str, Any]) -> Scalar:
    """Return displacement in cells and collected energy, weighted by the goal.

    A goal may name a measure instead.
    """
    goal = task.goal
    if goal.measure is not None:
        return goal.sign * values[goal.measure]
    displacement, energy = values["displacement"], values["energy"]
    if goal.energy == 0:
        return displacement
    if goal.displacement == 0:
        return goal.energy * energy
    return goal.displacement * displacement + goal.energy * energy


FEASIBLE = {
    "limits": ("limited", units.MAX_LIMITED),
    "compressible": ("mach", units.MAX_MACH),
    "impulse": ("impulse", units.MAX_IMPULSE),
}
"""The measure behind each status, and the largest value of a feasible creature."""


def judged(evaluation: Evaluation) -> Evaluation:
    """Return evaluations in NumPy with a status where limits acted, the flow was too fast, or
    a body pushed itself; the first reason counts."""
    measures, status = np.asarray(evaluation.measures), np.array(evaluation.status)
    for reason, (name, most) in FEASIBLE.items():
        beyond = measures[:, MEASURES.index(name)] > most
        status[(status == 0) & beyond] = STATUSES.index(reason)
    return eqx.tree_at(lambda one: one.status, evaluation, status)


def status(world: World, end: State, measures: Float[Array, "measure"]) -> Int[Array, ""]:
    """Return 0 if the evaluation is valid, else the code of the reason."""
    u = flow(world, end)
    last = jnp.sqrt(jnp.max(jnp.sum(u * u, 0)))
    fastest = jnp.maximum(measures[MEASURES.index("mach")], units.mach(last))
    finite = jnp.all(jnp.isfinite(measures)) & jnp.isfinite(fastest)
    # The expansion in Mach number is invalid from the lattice's speed of sound.
    return jnp.where(finite, jnp.where(fastest < 1, 0, 2), 1)
