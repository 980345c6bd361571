"""Derivatives of a creature's measures, by reverse mode through the whole simulation.

Variables are its genes, rest shape and stiffnesses, and the fluid's viscosity. Differentiation
treats as constant: the length of a displacement at its limit, the cells that a point acts on,
the share of time at a limit, counts of nodes and connections. See `docs/gradients.md`.
"""

from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from ..filaments import Rest
from ..genomes import CPPN, SEGMENT, BodyGraph, Drive, Genotype, Vector
from ..naming import WITHOUT_GRADIENT
from ..world import State, World
from .blocks import mapped
from .evaluation import fitness_of, in_trials, motion_of
from .simulation import drive, shift_energy, simulate
from .task import Actuator, Task

SHAPED = ("angle", "curl", "stiffness")
"""Genes of segments on which a body depends smoothly, between plans that grow differently."""

STIFFNESSES = ("stretch", "shear", "bend")

Values = dict[str, Float[Array, "..."]]


def parts(task: Task, actuator: Actuator, names: tuple[str, ...] | None = None) -> Values:
    """Return the present values of parts of a creature; None: of all that it has.

    `genes` are the weights, then the biases of a network, or a vector's numbers.
    `rest_angle` in rad is added to every joint's rest angle and `rest_length` to the logarithm
    of every edge's rest length, at all times: both are 0 as the creature is. A plan has
    `segment_angle`, `segment_curl` and `segment_stiffness` in place of a body's stiffnesses.
    """
    dtype = task.start.positions.dtype
    rods = jax.eval_shape(lambda: drive(task, actuator, differentiable=True).world.rods)
    found = {
        "rest_angle": jnp.zeros(rods.bend.shape, dtype),
        "rest_length": jnp.zeros(rods.stretch.shape, dtype),
        "viscosity": task.world.viscosity,
    }
    if isinstance(actuator, BodyGraph):
        genes = ((name, jnp.asarray(getattr(actuator.plan, name), dtype)) for name in SHAPED)
        found |= {SEGMENT + name: values for name, values in genes}
    else:
        found |= {name: getattr(task.world.rods, name) for name in STIFFNESSES}
    if not isinstance(actuator, Rest):
        found["genes"] = genes_of(actuator).astype(dtype)
    unknown = [name for name in names or () if name not in found]
    if unknown:
        raise ValueError(f"`by` must be of {', '.join(found)}, got {', '.join(unknown)}")
    return {name: found[name] for name in names or found}


def changed(task: Task, actuator: Actuator, values: Values) -> Drive:
    """Return the simulation of a creature whose parts have other values.

    Stiffnesses are those of the body before a genotype grows it.
    """
    world, rods = task.world, task.world.rods
    stiffness = {n: values[n] for n in STIFFNESSES if n in values}
    if stiffness:  # Softer bodies are swept.
        world = replace(world, rods=replace(rods, **stiffness), layout=None)
    if "viscosity" in values:
        world = replace(world, viscosity=values["viscosity"])
    if "genes" in values:
        actuator = with_genes(actuator, values["genes"])
    if isinstance(actuator, BodyGraph):
        shaped = {name: values[SEGMENT + name] for name in SHAPED if SEGMENT + name in values}
        actuator = replace(actuator, plan=actuator.plan._replace(**shaped))
    driven = drive(replace(task, world=world), actuator, differentiable=True)
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
    """Return fitness and measures of the creature with parts changed, after `horizon` steps.

    Raises `ValueError` for names that are unknown or have no derivative.
    """

    def measure(task: Task, driven: Drive) -> dict[str, Any]:
        end, observed = simulate(driven, segment=segment, differentiable=True)
        found = motion_of(task, driven, end, observed)
        return {**found, "fitness": fitness_of(task, found)}

    def measured(task: Task) -> dict[str, Any]:
        driven = changed(task, actuator, values)
        if horizon is not None:
            driven = replace(driven, inputs=jax.tree.map(lambda x: x[:horizon], driven.inputs))
        if task.placements is None:
            return measure(task, driven)
        # Checkpointed: what reverse mode keeps is one simulation's, not all of them.
        anew = jax.checkpoint(lambda x: measure(task, shift_energy(driven, x)))
        return _mean(jax.lax.map(anew, task.placements))

    if task.trials == 1:
        found = measured(task)
    else:
        found = _mean(in_trials(task, jax.checkpoint(measured)))
    known = [name for name in found if name not in WITHOUT_GRADIENT]
    unknown = [name for name in of if name not in known]
    if unknown:
        raise ValueError(f"`of` must be of {', '.join(known)}, got {', '.join(unknown)}")
    return jnp.stack([found[name] for name in of])


def _mean(found: dict[str, Any]) -> dict[str, Any]:
    return jax.tree.map(lambda x: jnp.mean(x, 0), found)


def value_and_jacobian(
    task: Task,
    actuator: Actuator,
    values: Values,
    of: tuple[str, ...] = ("fitness",),
    *,
    horizon: int | None = None,
    segment: int | None = None,
) -> tuple[Float[Array, "output"], Values]:
    """Return the result of `measures`, and its derivatives by each of `values`, outputs first.

    `segment` is that of `world.rollout`: without it the memory grows with the horizon.
    """
    found, pull = jax.vjp(
        lambda values: measures(task, actuator, values, of, horizon=horizon, segment=segment),
        values,
    )
    rows = mapped(lambda one: pull(one)[0], jnp.eye(len(of), dtype=found.dtype))
    return found, rows


def genes_of(actuator: Any) -> Float[Array, "gene"]:
    """Return genes as one vector: a network's weights and biases, or a vector's values."""
    if isinstance(actuator, Vector):
        return jnp.asarray(actuator.values)
    if isinstance(actuator, BodyGraph):
        return genes_of(actuator.network)
    return jnp.concatenate([jnp.asarray(actuator.weight), jnp.asarray(actuator.bias)])


def with_genes(actuator: Any, genes: Float[Array, "gene"]) -> Any:
    """Return the actuator with other genes; see `genes_of`."""
    if isinstance(actuator, Vector):
        return Vector(genes)
    if isinstance(actuator, BodyGraph):
        return replace(actuator, network=with_genes(actuator.network, genes))
    assert isinstance(actuator, CPPN)
    weights = actuator.weight.shape[0]
    return replace(actuator, weight=genes[:weights], bias=genes[weights:])


class Slopes(eqx.Module):
    """Derivatives by genes: of fitness first, then of every descriptor."""

    rows: Float[Array, "*block output gene"]
    finite: Bool[Array, "*block"]
    """True if the simulation and all derivatives stayed finite."""


def slopes(
    task: Task, genotype: Genotype, descriptors: tuple[str, ...], segment: int | None = None
) -> Slopes:
    """Return derivatives of fitness and of descriptors, by name, of one creature."""
    values = parts(task, genotype, ("genes",))
    of = ("fitness", *descriptors)
    found, rows = value_and_jacobian(task, genotype, values, of, segment=segment)
    finite = jnp.all(jnp.isfinite(found)) & jnp.all(jnp.isfinite(rows["genes"]))
    return Slopes(jnp.nan_to_num(rows["genes"]), finite)


def unit(rows: Float[Array, "*block gene"]) -> Float[Array, "*block gene"]:
    """Scale rows to length 1; those of length 0 stay."""
    length = jnp.sqrt(jnp.sum(rows * rows, -1, keepdims=True) + 1e-30)
    return rows / length
