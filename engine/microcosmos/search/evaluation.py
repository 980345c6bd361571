"""Evaluation of one creature, from its genome or stroke to fitness, measures and status."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PyTree

from .. import units
from ..filaments import Rest
from ..genomes import Drive, Genotype
from ..measures import FORMS
from ..world import Limits, Measures, State, World, flow, grown_nodes, route, together
from .measures import (
    MEASURES,
    MOTION,
    advance,
    cost_of_transport,
    kinematics,
    motion,
    recorded_motion,
    swimming,
)
from .simulation import clock_of, drive, is_native, shift_energy, simulate, strokes
from .task import Task
from .window import Poses, crossing, poses, summarise, window

STATUSES = (
    "ok",
    "non-finite",
    "supersonic",
    "limits",
    "compressible",
    "impulse",
    "crossing",
)
"""Outcome of an evaluation by status code: feasible, or the reason why not.

The last four are found by `judged`.
"""

Scalar = Float[Array, ""]


class Evaluation(eqx.Module):
    """The result for one creature, or for a block of them."""

    fitness: Float[Array, "*block"]
    measures: Float[Array, "*block measure"]
    status: Int[Array, "*block"]
    poses: Poses | None = None


def evaluate(task: Task, genotype: Genotype) -> Evaluation:
    """Simulate one creature in all trials and measure it.

    Returns the mean fitness and measures; `trial_spread` is the standard deviation of fitness.
    The largest values of `FEASIBLE` count, and the first trial's poses are kept.
    """
    return over_trials(task, lambda one: evaluate_drive(one, genotype, drive(one, genotype)))


def over_trials(task: Task, evaluation: Callable[[Task], Evaluation]) -> Evaluation:
    """Return the evaluation of a creature from those in the task of every trial."""
    if task.trials == 1:
        return evaluation(task)
    trials = in_trials(task, evaluation)
    measures = _measures(trials)
    measures = measures.at[MEASURES.index("trial_spread")].set(jnp.std(trials.fitness, ddof=1))
    return _combined(trials, measures)


def _measures(several: Evaluation) -> Float[Array, "measure"]:
    """Return the means of measures over several simulations, of `FEASIBLE` the largest."""
    measures = jnp.mean(several.measures, 0)
    # A mean could hide the one simulation in which limits acted.
    for name, _ in FEASIBLE.values():
        at = MEASURES.index(name)
        measures = measures.at[at].set(jnp.max(several.measures[:, at]))
    return measures


def _combined(several: Evaluation, measures: Float[Array, "measure"]) -> Evaluation:
    first = jax.tree.map(lambda x: x[0], several.poses)
    return Evaluation(jnp.mean(several.fitness), measures, jnp.max(several.status), first)


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
    if task.phase is not None:
        phase = phase + task.phase
    return replace(task, phase=phase, turn=jnp.pi / 4 * number, trials=1)


def evaluate_drive(task: Task, genotype: Genotype, driven: Drive) -> Evaluation:
    """Simulate and measure a developed genotype in all placements, as in trials."""
    if task.placements is None:
        return _evaluate(task, genotype, driven)
    placed = jax.lax.map(
        lambda shift: _evaluate(task, genotype, shift_energy(driven, shift)), task.placements
    )
    return _combined(placed, _measures(placed))


def _evaluate(task: Task, genotype: Genotype, driven: Drive) -> Evaluation:
    if task.encoding is None:
        raise ValueError("`task.encoding` must say what the genotype means; got None.")
    end, observed = simulate(driven)
    values, poses_seen, valid = measured(task, driven, end, observed)
    values["crossing"] = crossing(poses_seen, driven.start.positions)
    values["hidden_nodes"], values["connections"] = task.encoding.size(genotype)
    values |= form_of(task, driven)
    dtype = observed.centre.dtype
    measures = jnp.stack([values[name].astype(dtype) for name in task.measures])
    # Bounded outputs can hide that a gene is not finite
    # (tests/engine/search/test_finite_genes.py).
    finite = all_finite(measures) & all_finite(genotype)
    valid = jnp.where(finite, valid, STATUSES.index("non-finite"))
    return Evaluation(fitness_of(task, values).astype(dtype), measures, valid, poses_seen)


def all_finite(tree: PyTree) -> Bool[Array, ""]:
    """Return whether all numbers are finite; bounded outputs can hide that a gene is not."""
    numbers = [x for x in jax.tree.leaves(tree) if jnp.issubdtype(x.dtype, jnp.floating)]
    return jnp.all(jnp.stack([jnp.all(jnp.isfinite(one)) for one in numbers]))


def measured(
    task: Task, driven: Drive, end: State, observed: Measures
) -> tuple[dict[str, Any], Poses, Int[Array, ""]]:
    """Return measures by name, poses and status of a motion."""
    if not is_native(driven):
        values = motion_of(task, driven, end, observed)
        valid = status(driven.world, end, values["mach"])
        return values, poses_of(task, driven, observed), valid
    # In JAX measures and poses took 1.2 ms of the 13.1 ms of a creature of `standard`, here 0.2
    # ms, and the program compiles in 2.0 s instead of 7.7 s (docs/physics.md).
    world, start, clock = driven.world, driven.start, clock_of(driven, len(observed.power))
    length = length_of(task, driven)
    values, poses_seen, valid = summarise(
        world, start, end, observed, clock, task.period, length
    )
    # The kernel knows no trials, but every evaluation has the same columns.
    values["trial_spread"] = jnp.zeros_like(values["speed"])
    return with_named(task, driven, end, observed, values), poses_seen, valid


def motion_of(task: Task, driven: Drive, end: State, observed: Measures) -> dict[str, Any]:
    """Return measures of any actuator's motion."""
    length = length_of(task, driven)
    path = route(driven.world, driven.start, observed)
    values = motion(driven.world, driven.start, end, observed, path, length)
    done = strokes(driven, task.period, len(observed.centre))
    values["speed"], values["stride"] = swimming(path.places[1:], done, length)
    values["advance"] = advance(path.places[1:], done, length)
    values["cost_of_transport"] = cost_of_transport(path.places, observed, done, length)
    values |= kinematics(driven.world, observed, path, window(done), length)
    values["trial_spread"] = jnp.zeros_like(values["speed"])
    return with_named(task, driven, end, observed, values)


def with_named(
    task: Task, driven: Drive, end: State, observed: Measures, values: dict[str, Any]
) -> dict[str, Any]:
    """Add the measures that the task names to the usual ones."""
    if not task.named_measures:
        return values
    whole = recorded_motion(driven.world, driven.start, end, observed, values, task.copies)
    return values | {measure.name: measure.of(whole) for measure in task.named_measures}


def length_of(task: Task, driven: Drive) -> Scalar | float:
    """Return the length of the body that was simulated, in cells."""
    return task.length if driven.length is None else driven.length


def poses_of(task: Task, driven: Drive, observed: Measures) -> Poses:
    """Return the pose stream of a simulation."""
    length = length_of(task, driven)
    last = window(strokes(driven, task.period, len(observed.centre)))
    box, path = driven.world, route(driven.world, driven.start, observed)
    at, present, edges = last.places(), grown_nodes(box), box.rods.edges
    frames = together(box, observed.positions[at], observed.boxes[at])
    return poses(path.places, frames, path.cells[at + 1], present, edges, last, length)


def form_of(task: Task, driven: Drive) -> Mapping[str, Array]:
    """Return the measures of the form of the body that was simulated."""
    if driven.form is not None:
        return driven.form
    return dict(zip(FORMS, map(jnp.asarray, task.form), strict=True))


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
    "crossing": ("crossing", units.MAX_CROSSING),
}
"""The measure behind each status, and the largest value of a feasible creature."""


def judged(evaluation: Evaluation) -> Evaluation:
    """Return evaluations, in NumPy or JAX, with a status where limits acted, the flow was too
    fast, a body pushed itself, or filaments crossed; the first reason counts."""
    status = evaluation.status
    for reason, (name, most) in FEASIBLE.items():
        beyond = evaluation.measures[:, MEASURES.index(name)] > most
        # A product, which arrays of both libraries know: QDax judges within its program.
        judged_so = ((status == 0) & beyond).astype(status.dtype)
        status = status + judged_so * STATUSES.index(reason)
    return eqx.tree_at(lambda one: one.status, evaluation, status)


def status(world: World, end: State, mach: Scalar) -> Int[Array, ""]:
    """Return 0 if the flow is finite and subsonic, else the code of the reason; `mach` is the
    largest during the simulation."""
    u = flow(world, end)
    last = jnp.sqrt(jnp.max(jnp.sum(u * u, 0)))
    fastest = jnp.maximum(mach, units.mach(last))
    # The expansion in Mach number is invalid from the lattice's speed of sound.
    return jnp.where(jnp.isfinite(fastest), jnp.where(fastest < 1, 0, 2), 1)


STROKE_MEASURES = (
    *MOTION,
    "energy",
    "mach",
    "limited",
    "reynolds",
    "cycle_x",
    "cycle_y",
    "impulse",
)
"""Measures of every stroke, in this order; units in `docs/formats.md`."""


class Conditions(eqx.Module):
    """The conditions of one point of a sweep."""

    viscosity: Float[Array, "*block"]
    limits: Limits


def in_conditions(task: Task, conditions: Conditions) -> Task:
    """Return the task of one body that is simulated once, in the conditions of a point."""
    world = replace(task.world, viscosity=conditions.viscosity, limits=conditions.limits)
    return replace(task, world=world, trials=1, placements=None, places=None)


def swim(task: Task, rest: Rest, conditions: Conditions, period: int) -> Evaluation:
    """Carry out a stroke under its conditions and measure its last cycle."""
    task = in_conditions(task, conditions)
    driven = drive(task, rest)
    end, observed = simulate(driven)
    values, poses, valid = measured(task, driven, end, observed)
    whole = len(observed.power) > period
    path = route(driven.world, driven.start, observed)
    # The kernel's own place at the start, which a page has too.
    moved = path.way(-1 - period, -1) if whole else path.places[-1] - poses.path[0]
    values["cycle_x"], values["cycle_y"] = moved
    measures = jnp.stack([values[name] for name in STROKE_MEASURES])
    valid = jnp.where(all_finite(measures), valid, STATUSES.index("non-finite"))
    return Evaluation(fitness_of(task, values), measures, valid)
