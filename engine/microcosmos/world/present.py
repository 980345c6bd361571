"""Masks of the nodes, edges and joints of partly grown bodies."""

from dataclasses import replace

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .. import filaments
from .model import State, World


def grown_nodes(world: World) -> Bool[Array, "node"]:
    """Return the mask of all nodes that have grown."""
    present = world.present
    return jnp.ones(len(world.groups.member), bool) if present is None else present


def there(world: World, layers: int = 1) -> Bool[Array, "point"] | None:
    """Return the mask of points of present nodes; None: all."""
    if world.present is None or layers == 1:
        return world.present
    return jnp.repeat(world.present, layers)


def edges_there(world: World) -> Bool[Array, "edge"] | None:
    """Return the mask of edges with both ends; None: all."""
    return None if world.present is None else jnp.all(world.present[world.rods.edges], 1)


def joints_there(world: World) -> Bool[Array, "joint"] | None:
    """Return the mask of joints with both edges; None: all."""
    edges, joints = edges_there(world), world.rods.joints
    return None if edges is None or joints is None else jnp.all(edges[joints], 1)


def grown_rods(rods: filaments.Rods, present: Bool[Array, "node"]) -> filaments.Rods:
    """Remove the constraints on absent nodes."""
    assert rods.joints is not None
    edges = jnp.all(present[rods.edges], 1)
    return replace(
        rods,
        stretch=jnp.where(edges, rods.stretch, 0.0),
        shear=jnp.where(edges, rods.shear, 0.0),
        bend=jnp.where(jnp.all(edges[rods.joints], 1), rods.bend, 0.0),
    )


def mean(values: Float[Array, "item *rest"], kept: Bool[Array, "item"] | None):
    """Return the mean of present items, over the first axis."""
    if kept is None:
        return jnp.mean(values, 0)
    mask = kept.reshape(-1, *(1,) * (values.ndim - 1))
    return jnp.sum(jnp.where(mask, values, 0.0), 0) / jnp.sum(kept)


def centre(world: World, state: State) -> Float[Array, "2"]:
    """Return the mean unwrapped node position, in cells."""
    return mean(state.positions, world.present)
