"""Evaluation: from genomes to fitness, descriptors and features.

The unit is one compiled program for a fixed number of creatures. Rollouts are chaotic, so
rounding counts, and a program of another shape rounds differently: whatever the batch,
slot, neighbours or device, a creature goes through this same program.
"""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ..filaments import Rest
from ..genomes import CPPN, OUTPUTS, Controls, develop
from ..world import State, World, flow, rollout

FEATURES = (
    "displacement",
    "bending_effort",
    "stretching_effort",
    "path_length",
    "straightness",
    "rotation",
    "hidden_nodes",
    "connections",
)
"""What is recorded of every elite, in this order; units in `docs/formats.md`."""

STATUSES = ("ok", "non-finite", "supersonic")
"""Why an evaluation counts or does not, by status code."""

SOUND_SPEED = 3**-0.5


class Evaluation(eqx.Module):
    """What was measured of one creature (or of a block of them)."""

    fitness: Float[Array, "*block"]
    features: Float[Array, "*block feature"]
    status: Int[Array, "*block"]


class Task(eqx.Module):
    """A world with a body at its start, and what its controller's outputs mean."""

    world: World
    start: State
    controls: Controls = eqx.field(static=True)


def evaluate(task: Task, network: CPPN) -> Evaluation:
    """Simulate one creature; fitness is the displacement of its mean node, in cells."""
    rest = develop(network, task.controls)
    end, centres = rollout(task.world, task.start, rest, centre)
    features = measure(task, network, rest, end, centres)
    fitness = features[FEATURES.index("displacement")]
    return Evaluation(fitness, features, status(task.world, end, features))


def centre(state: State) -> Float[Array, "2"]:
    """The mean unwrapped node position, in cells."""
    return jnp.mean(state.positions, 0)


def measure(
    task: Task, network: CPPN, rest: Rest, end: State, centres: Float[Array, "time 2"]
) -> Float[Array, "feature"]:
    """The features of a simulated creature, in the order of `FEATURES`."""
    start = centre(task.start)
    moved = jnp.diff(jnp.concatenate([start[None], centres]), axis=0)
    displacement, path = _norm(centres[-1] - start), jnp.sum(_norm(moved))
    fixed = task.controls.inputs.shape[0] + OUTPUTS
    values = {
        "displacement": displacement,
        "bending_effort": effort(rest.angle),
        "stretching_effort": effort(rest.length),
        "path_length": path,
        "straightness": displacement / jnp.maximum(path, 1e-12),
        "rotation": jnp.mean(end.angles - task.start.angles),
        "hidden_nodes": jnp.sum(network.node_used) - fixed,
        "connections": jnp.sum(network.connection_used & network.enabled),
    }
    return jnp.stack([values[name].astype(displacement.dtype) for name in FEATURES])


def effort(rest: Float[Array, "time item"]) -> Float[Array, ""]:
    """Σ over time and items of the squared change from one step to the next."""
    return jnp.sum(jnp.diff(rest, axis=0) ** 2)


def status(world: World, end: State, features: Float[Array, "feature"]) -> Int[Array, ""]:
    """0 where the numbers can be believed, else why they cannot."""
    u = flow(world, end)
    fastest = jnp.sqrt(jnp.max(jnp.sum(u * u, 0)))
    finite = jnp.all(jnp.isfinite(features)) & jnp.isfinite(fastest)
    # At the lattice's speed of sound the expansion in Mach number means nothing any more.
    return jnp.where(finite, jnp.where(fastest < SOUND_SPEED, 0, 2), 1)


def block_program(
    task: Task, evaluate: Callable, options: dict
) -> Callable[[CPPN], Evaluation]:
    """One compiled program that evaluates a block, one creature after another on a CPU.

    On a CPU one world fits in a core's cache and a block keeps one core busy (measured
    faster than a batch, with a device a core); elsewhere the block is one batch.
    """

    def block(networks: CPPN) -> Evaluation:
        if jax.default_backend() == "cpu":
            return jax.lax.map(lambda network: evaluate(task, network), networks)
        return jax.vmap(lambda network: evaluate(task, network))(networks)

    return jax.jit(block, compiler_options=options)


def _norm(v: Float[Array, "*batch 2"]) -> Float[Array, "*batch"]:
    return jnp.sqrt(jnp.sum(v * v, -1) + 1e-24)
