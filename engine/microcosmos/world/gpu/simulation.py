"""Rollouts in the kernel for GPUs: the worlds that it covers, its operands and its measures."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ... import coupling, device, filaments, fluid
from ..model import Measures, State, World, anchors, grown_nodes, mean, present_edges
from ..stepping import curvature
from .plan import Plan

MOST_NODES = 64
"""Nodes of a world; time and memory grow with their square."""
PROJECTIONS = (coupling.force_free, coupling.torque_free)


def chosen(world: World, state: State) -> bool:
    """Return whether the kernel simulates a world that follows rest shapes."""
    return device.has_gpu_kernel() and uncovered(world, state) is None


def uncovered(world: World, state: State) -> str | None:
    """Return the feature that the kernel lacks for a world; None if it simulates the world."""
    layout, around = world.layout, world.surroundings
    lacking = {
        "no fluid": not world.form.fluid,
        "several bodies": world.groups.count > 1,
        "constraints that are swept": layout is None,
        "several pieces": layout is not None and layout.pieces.count > 1,
        "soft joints": layout is not None and layout.bend is not None,
        "layers": world.form.layers > 1,
        "forcing of another projection": world.form.projection not in PROJECTIONS,
        "repulsion": any(
            one is not None for one in (world.steric, world.contact, world.barrier)
        ),
        "energy": state.energy is not None,
        "surroundings": any(one is not None for one in vars(around).values()),
        "so many nodes": len(state.positions) > MOST_NODES,
        "numbers other than float32": state.positions.dtype != jnp.float32,
        "a body without joints listed": world.rods.joints is None,
    }
    return next((reason for reason, holds in lacking.items() if holds), None)


def rollout(
    world: World, state: State, rest: filaments.Rest, *, interpreted: bool = False
) -> tuple[State, Measures]:
    """Return the state after all steps of rest shapes (time first), and their measures.

    The kernel has no derivatives. `interpreted` runs it without a GPU.
    """
    from . import kernel  # Pallas takes half a second to import.

    nodes, plan = len(state.positions), plan_of(world, state, rest, interpreted)
    populations, *motion = kernel.rollout(plan, operands_of(plan, world, state, rest))
    path, matched = (jnp.swapaxes(one, 1, 2)[:, :nodes] for one in motion[:2])
    numbers = dict(zip(kernel.OBSERVED, motion[2].T, strict=True))
    # Angles are those of the positions before the limit, as `stepping` leaves them.
    angles = _followed(state.angles, matched, world.rods)
    force = jnp.stack([numbers.pop("force_x"), numbers.pop("force_y")], 1)[:, None]
    changes = jnp.stack([numbers.pop("box_x"), numbers.pop("box_y")], 1)[:, None]
    boxes = state.boxes[None] + jnp.cumsum(changes, 0)
    end = replace(
        state,
        populations=tuple(populations),
        positions=path[-1],
        angles=angles[-1],
        boxes=boxes[-1],
    )

    def measure(positions, angles, boxes, rest, force, numbers):
        return Measures(
            centre=mean(positions, world.present),
            positions=positions,
            boxes=boxes,
            rest=rest,
            heading=mean(angles, present_edges(world)),
            curvature=curvature(world, positions, angles),
            force=force,
            **numbers,
        )

    return end, jax.vmap(measure)(path, angles, boxes, rest, force, numbers)


def plan_of(world: World, state: State, rest: filaments.Rest, interpreted: bool) -> Plan:
    """Return the parts of a rollout that are fixed when its program is compiled."""
    form, nodes = world.form, len(state.positions)
    return Plan(
        size=world.size,
        steps=len(rest.angle),
        nodes=max(
            16, 1 << (nodes - 1).bit_length()
        ),  # Sizes of Triton's arrays are powers of two.
        delta=form.kernel,
        lengths=tuple(map(float, coupling.step_lengths(form.forcing_iterations))),
        turns=form.projection is coupling.torque_free,
        force_factor=form.force_factor,
        interpreted=interpreted,
    )


def operands_of(plan: Plan, world: World, state: State, rest: filaments.Rest) -> list[Array]:
    """Return the operands of the kernel. Nodes that fill up a power of two are absent."""
    assert world.layout is not None
    dtype, nodes = state.positions.dtype, len(state.positions)
    filled = plan.nodes - nodes
    # They stand where the last node does: their windows then lie within the box.
    positions = jnp.pad(state.positions.T, ((0, 0), (0, filled)), mode="edge")
    shapes = filaments.rest_positions(rest, world.layout)
    middles = jax.vmap(lambda one: mean(one, world.present))(shapes)
    shapes = jnp.swapaxes(shapes - middles[:, None], 1, 2)
    rates, limits = fluid.rates(world.viscosity, world.form.magic), world.limits
    bounds = [jnp.inf if one is None else one for one in (limits.displacement, limits.force)]
    values = [rates.even, rates.odd, *bounds]
    return [
        jnp.stack(state.populations).reshape(-1),
        positions,
        jnp.pad(grown_nodes(world).astype(dtype), (0, filled)),
        (jnp.arange(plan.nodes) == anchors(world)).astype(dtype),
        jnp.pad(shapes, ((0, 0), (0, 0), (0, filled))),
        jnp.stack([jnp.asarray(one, dtype) for one in values]),
    ]


def _followed(
    start: Float[Array, "edge"], positions: Float[Array, "time node 2"], rods: filaments.Rods
) -> Float[Array, "time edge"]:
    """Return the angles of edges over time, on the branches nearest to those before."""
    angles = jax.vmap(lambda one: filaments.edge_angles(one, rods))(positions)
    steps = jnp.diff(angles, axis=0, prepend=start[None])
    return angles - 2 * jnp.pi * jnp.cumsum(jnp.round(steps / (2 * jnp.pi)), 0)
