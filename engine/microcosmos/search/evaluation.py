"""Evaluation: from genomes to fitness, descriptors and features.

The unit is one compiled program for a fixed number of creatures. Rollouts are chaotic, so
rounding counts, and a program of another shape rounds differently: whatever the batch,
slot, neighbours or device, a creature goes through this same program.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PyTree

from .. import units
from ..filaments import Rest
from ..genomes import Drive, Encoding, Genotype
from ..world import Measures, State, World, flow, rollout

MOTION = (
    "displacement",
    "bending_effort",
    "stretching_effort",
    "path_length",
    "straightness",
    "rotation",
)
FEATURES = (*MOTION, "hidden_nodes", "connections", "energy", "mach", "limited", "reynolds")
"""What is recorded of every elite, in this order; units in `docs/formats.md`."""

STATUSES = ("ok", "non-finite", "supersonic")
"""Why an evaluation counts or does not, by status code."""

Actuator = Genotype | Rest
"""What moves a body: what is inherited, or rest shapes over time."""


class Evaluation(eqx.Module):
    """What was measured of one creature (or of a block of them)."""

    fitness: Float[Array, "*block"]
    features: Float[Array, "*block feature"]
    status: Int[Array, "*block"]


class Goal(eqx.Module):
    """What fitness is made of: its weight on displacement and on collected energy."""

    displacement: float = eqx.field(static=True, default=1.0)
    energy: float = eqx.field(static=True, default=0.0)


class Task(eqx.Module):
    """A world with a body at its start, what genotypes mean there, and the goal."""

    world: World
    start: State
    encoding: Encoding | None = eqx.field(static=True, default=None)
    goal: Goal = Goal()
    length: float = eqx.field(static=True, default=1.0)
    """How far the body reaches, in cells: the length in the Reynolds number."""
    phase: Float[Array, ""] | None = None
    """How far a periodic timer is ahead, in rad."""


class Seen(eqx.Module):
    """What is observed in every step."""

    centre: Float[Array, "*time 2"]
    rest: Rest
    speed: Float[Array, "*time"]
    pace: Float[Array, "*time"]
    held: Float[Array, "*time"]


def evaluate(task: Task, genotype: Genotype) -> Evaluation:
    """Simulate one creature and measure it."""
    driven = drive(task, genotype)
    end, seen = rollout(driven.world, driven.start, driven.inputs, observe, driven.control)
    features = measure(task, genotype, driven.start, end, seen)
    return Evaluation(fitness(task, features), features, status(driven.world, end, features))


def drive(task: Task, actuator: Actuator) -> Drive:
    """What is simulated of a genotype, or of a body that follows rest shapes."""
    if isinstance(actuator, Rest) or task.encoding is None:
        return Drive(task.world, task.start, actuator)
    return task.encoding.drive(task.world, task.start, actuator, task.phase)


def observe(state: State, measures: Measures) -> Seen:
    """What features are made of."""
    return Seen(
        centre=centre(state),
        rest=measures.rest,
        speed=measures.speed,
        pace=measures.pace,
        held=measures.held,
    )


def centre(state: State) -> Float[Array, "2"]:
    """The mean unwrapped node position, in cells."""
    return jnp.mean(state.positions, 0)


def measure(
    task: Task, genotype: Genotype, start: State, end: State, seen: Seen
) -> Float[Array, "feature"]:
    """The features of a simulated creature, in the order of `FEATURES`."""
    values = motion(replace(task, start=start), end, seen)
    if task.encoding is None:
        raise ValueError("`task.encoding` must say what the genotype means; got None.")
    values["hidden_nodes"], values["connections"] = task.encoding.size(genotype)
    dtype = seen.centre.dtype
    return jnp.stack([values[name].astype(dtype) for name in FEATURES])


def motion(task: Task, end: State, seen: Seen) -> dict[str, Any]:
    """What can be measured of any actuator's motion."""
    start = centre(task.start)
    moved = jnp.diff(jnp.concatenate([start[None], seen.centre]), axis=0)
    displacement, path = _norm(seen.centre[-1] - start), jnp.sum(_norm(moved))
    return {
        "displacement": displacement,
        "bending_effort": effort(seen.rest.angle),
        "stretching_effort": effort(seen.rest.length),
        "path_length": path,
        "straightness": displacement / jnp.maximum(path, 1e-12),
        "rotation": jnp.mean(end.angles - task.start.angles),
        "energy": jnp.zeros(()) if end.collected is None else jnp.sum(end.collected),
        "mach": units.mach(jnp.max(seen.speed)),
        "limited": jnp.mean(seen.held),
        "reynolds": units.reynolds(jnp.mean(seen.pace), task.length, task.world.viscosity),
    }


def fitness(task: Task, features: Float[Array, "feature"]) -> Float[Array, ""]:
    """Displacement in cells, collected energy, or both, as the goal weighs them."""
    goal = task.goal
    if goal.energy == 0:
        return features[FEATURES.index("displacement")]
    energy = goal.energy * features[FEATURES.index("energy")]
    if goal.displacement == 0:
        return energy
    return goal.displacement * features[FEATURES.index("displacement")] + energy


def effort(rest: Float[Array, "time item"]) -> Float[Array, ""]:
    """Σ over time and items of the squared change from one step to the next."""
    return jnp.sum(jnp.diff(rest, axis=0) ** 2)


def status(world: World, end: State, features: Float[Array, "feature"]) -> Int[Array, ""]:
    """0 where the numbers can be believed, else why they cannot."""
    u = flow(world, end)
    last = jnp.sqrt(jnp.max(jnp.sum(u * u, 0)))
    fastest = jnp.maximum(features[FEATURES.index("mach")], units.mach(last))
    finite = jnp.all(jnp.isfinite(features)) & jnp.isfinite(fastest)
    # At the lattice's speed of sound the expansion in Mach number means nothing any more.
    return jnp.where(finite, jnp.where(fastest < 1, 0, 2), 1)


def block_program(
    task: Task, evaluate: Callable, options: dict
) -> Callable[[Genotype], Evaluation]:
    """One compiled program that evaluates a block of genotypes."""
    return jax.jit(
        lambda genotypes: mapped(lambda genotype: evaluate(task, genotype), genotypes),
        compiler_options=options,
    )


def mapped(function: Callable, block: PyTree[Array]) -> Any:
    """A function of every item of a block: one after another on a CPU, elsewhere a batch.

    On a CPU one world fits in a core's cache and a block keeps one core busy (measured
    faster than a batch, with a device a core).
    """
    if jax.default_backend() == "cpu":
        return jax.lax.map(function, block)
    return jax.vmap(function)(block)


def _norm(v: Float[Array, "*batch 2"]) -> Float[Array, "*batch"]:
    return jnp.sqrt(jnp.sum(v * v, -1) + 1e-24)
