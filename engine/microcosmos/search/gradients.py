"""Derivatives of what is measured of a creature, by reverse mode through its whole life.

They can be taken with respect to its genes, its rest shape, its stiffnesses and the fluid's
viscosity. What cuts them: where a limit acts on a displacement its length no longer counts;
the cells that a point acts on are taken as they are; a mean over the time that limits act, and
counts of nodes and connections, have no derivative. `docs/gradients.md` says more.
"""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..filaments import Rest
from ..genomes import CPPN, Drive, Vector
from ..world import State, World
from .evaluation import (
    Actuator,
    Task,
    drive,
    elsewhere,
    fitness_of,
    mapped,
    motion_of,
    simulate,
)

PARTS = ("genes", "rest_angle", "rest_length", "stretch", "shear", "bend", "viscosity")
"""What a derivative can be taken by."""

CONSTANT = ("hidden_nodes", "connections", "nodes", "limited")
"""Measures that no small change changes, or that count."""

Values = dict[str, Float[Array, "..."]]


def parts(task: Task, actuator: Actuator, names: tuple[str, ...] = PARTS) -> Values:
    """The present values of parts of a creature.

    `genes` are the weights, then the biases of a network, or a vector's numbers.
    `rest_angle` in rad is added to every joint's rest angle and `rest_length` to the logarithm
    of every edge's rest length, at all times: both are 0 as the creature is.
    """
    rods = task.world.rods
    dtype = task.start.positions.dtype
    found = {
        "rest_angle": jnp.zeros(rods.bend.shape, dtype),
        "rest_length": jnp.zeros(rods.stretch.shape, dtype),
        "stretch": rods.stretch,
        "shear": rods.shear,
        "bend": rods.bend,
        "viscosity": task.world.viscosity,
    }
    if not isinstance(actuator, Rest):
        found["genes"] = genes_of(actuator).astype(dtype)
    unknown = [name for name in names if name not in found]
    if unknown:
        raise ValueError(f"`by` must be of {', '.join(found)}, got {', '.join(unknown)}")
    return {name: found[name] for name in names}


def changed(task: Task, actuator: Actuator, values: Values) -> Drive:
    """What is simulated of a creature some parts of which have other values.

    Stiffnesses are those of the body before a genotype grows it.
    """
    world, rods = task.world, task.world.rods
    stiffness = {n: values[n] for n in ("stretch", "shear", "bend") if n in values}
    world = replace(world, rods=replace(rods, **stiffness))
    if "viscosity" in values:
        world = replace(world, viscosity=values["viscosity"])
    if "genes" in values:
        actuator = with_genes(actuator, values["genes"])
    driven = drive(replace(task, world=world), actuator)
    if not {"rest_angle", "rest_length"} & values.keys():
        return driven

    def control(world: World, state: State, given: Any) -> Rest:
        rest = driven.control(world, state, given)
        angle, length = values.get("rest_angle", 0.0), values.get("rest_length", 0.0)
        return Rest(rest.angle + angle, rest.length * jnp.exp(length))

    return replace(driven, control=control)


def measures(
    task: Task,
    actuator: Actuator,
    values: Values,
    of: tuple[str, ...] = ("fitness",),
    *,
    horizon: int | None = None,
    segment: int | None = None,
) -> Float[Array, "output"]:
    """Fitness and measures of the creature with parts changed, after `horizon` steps.

    Raises `ValueError` for names that are none, or that have no derivative.
    """
    driven = changed(task, actuator, values)
    if horizon is not None:
        driven = replace(driven, inputs=jax.tree.map(lambda x: x[:horizon], driven.inputs))

    def measure(driven: Drive) -> dict[str, Any]:
        end, observed = simulate(driven, segment=segment)
        found = motion_of(task, driven, end, observed)
        return {**found, "fitness": fitness_of(task, found)}

    if task.placements is None:
        found = measure(driven)
    else:
        # Checkpointed: what reverse mode keeps is one world's, not all of them.
        anew = jax.checkpoint(lambda x: measure(elsewhere(driven, x)))
        worlds = jax.lax.map(anew, task.placements)
        found = jax.tree.map(lambda x: jnp.mean(x, 0), worlds)
    known = [name for name in found if name not in CONSTANT]
    unknown = [name for name in of if name not in known]
    if unknown:
        raise ValueError(f"`of` must be of {', '.join(known)}, got {', '.join(unknown)}")
    return jnp.stack([found[name] for name in of])


def value_and_jacobian(
    task: Task,
    actuator: Actuator,
    values: Values,
    of: tuple[str, ...] = ("fitness",),
    *,
    horizon: int | None = None,
    segment: int | None = None,
) -> tuple[Float[Array, "output"], Values]:
    """What `measures` gives, and its derivatives by each of `values`, outputs first.

    `segment` is that of `world.rollout`: without it the memory grows with the horizon.
    """
    found, pull = jax.vjp(
        lambda values: measures(task, actuator, values, of, horizon=horizon, segment=segment),
        values,
    )
    rows = mapped(lambda one: pull(one)[0], jnp.eye(len(of), dtype=found.dtype))
    return found, rows


def genes_of(actuator: Any) -> Float[Array, "gene"]:
    """The numbers that a derivative by genes is taken by."""
    if isinstance(actuator, Vector):
        return jnp.asarray(actuator.values)
    return jnp.concatenate([jnp.asarray(actuator.weight), jnp.asarray(actuator.bias)])


def with_genes(actuator: Any, genes: Float[Array, "gene"]) -> Any:
    """The same with other numbers."""
    if isinstance(actuator, Vector):
        return Vector(genes)
    assert isinstance(actuator, CPPN)
    weights = actuator.weight.shape[0]
    return replace(actuator, weight=genes[:weights], bias=genes[weights:])
