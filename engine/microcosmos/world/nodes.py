"""Nodes: steric repulsion, sensing and collecting energy."""

from dataclasses import replace

import jax.numpy as jnp
from jaxtyping import Array, Float

from .. import coupling, fields
from .model import State, World

Vectors = Float[Array, "node 2"]


def sense(world: World, state: State) -> Float[Array, "node"]:
    """Return the energy at each node; zero in a world without energy."""
    if state.energy is None:
        return jnp.zeros_like(state.positions[:, 0])
    at = coupling.windows(state.positions, world.size, world.form.kernel)
    return coupling.interpolate(state.energy[None], at)[:, 0]


def collect(world: World, state: State, at: coupling.Windows) -> State:
    """Return the state after nodes took energy at their positions before the step."""
    energy, field = world.energy, state.energy
    if energy is None or field is None:
        return state
    per_node = field
    if energy.rate is not None:
        ones = jnp.ones((at.points, 1), field.dtype) / world.form.layers
        coverage = coupling.spread(ones, at, world.size)[0]
        field, per_node = fields.collect(field, coverage, energy.rate)
    if energy.diffusion is not None:
        field = fields.diffuse(field, energy.diffusion)
    taken = coupling.interpolate(per_node[None], at)
    taken = coupling.at_nodes(jnp.tile(taken, (1, 2)), world.form.layers)[:, 0]
    before = 0.0 if state.collected is None else state.collected
    return replace(state, energy=field, collected=before + taken)


def repel(world: World, positions: Vectors) -> tuple[Vectors, Vectors]:
    """Return steric displacements within bodies, and of each body as a whole.

    The forcing on a body sums to zero, which would remove its mean displacement; so the mean
    is returned apart and moves the body after the fluid's response. It is taken before
    displacements are limited, so that repulsion within a body cannot move the body.
    """
    if world.steric is None:
        return jnp.zeros_like(positions), jnp.zeros_like(positions)
    at = coupling.masked(coupling.windows(positions, world.size, coupling.HAT), world.present)
    density = coupling.spread(jnp.ones_like(positions[:, :1]), at, world.size)[0]
    push = -world.steric.strength * coupling.interpolate(world.steric.gradient(density), at)
    drift = _body_mean(world, push)
    push = fields.capped(push - drift, world.steric.limit)
    return push - _body_mean(world, push), fields.capped(drift, world.steric.limit)


def _body_mean(world: World, values: Vectors) -> Vectors:
    ones = jnp.ones_like(values)
    if world.present is not None:
        ones = ones * world.present[:, None]
        values = values * ones
    nodes = world.groups.total(ones)
    return world.groups.per_node(world.groups.total(values) / nodes)
