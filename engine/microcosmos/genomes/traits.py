"""Bodies with inherited traits: rest angles and lengths, stiffness, and number of nodes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from ..bodies import Layout
from ..portable import cosine, product, sine
from ..world import State, World, centre, grown_rods, with_bodies
from .development import Controls

Traits = Mapping[str, Array]
"""Values of each joint or edge, by trait."""

STIFFNESSES = ("stretch", "shear", "bend")


@dataclass(frozen=True)
class Shaped:
    """A shaped body: the world and start with it, and controls with its rest shape."""

    world: World
    start: State
    controls: Controls
    length: Float[Array, ""] | None = None
    """Extent in cells; None: that of the task's body."""


def within(values: Array, bounds: tuple[float, float]) -> Array:
    """Map values from −1 to 1 to the range between bounds."""
    low, high = bounds
    return low + (high - low) * 0.5 * (1 + values)


def shaped(
    world: World, start: State, controls: Controls, layout: Layout | None, traits: Traits
) -> Shaped:
    """Return the body with inherited traits, laid out anew where its shape changes.

    `rest_angle` is added to rest angles, `rest_length` multiplies rest lengths.
    """
    stiffness = {name: traits[name] for name in STIFFNESSES if name in traits}
    if stiffness:  # A soft body has no closed form.
        world = replace(world, rods=replace(world.rods, **stiffness), layout=None)
    if layout is None:
        return Shaped(world, start, controls)
    dtype = start.positions.dtype
    factor = traits.get("rest_length", jnp.ones(len(layout.angle), dtype))
    turns = traits.get("rest_angle", jnp.zeros(len(layout.joints), dtype))
    turned = product(jnp.asarray(layout.turned, dtype), turns[:, None])[:, 0]
    length = jnp.asarray(controls.rest_length, dtype) * factor
    positions = _laid_out(layout, turned, length) + jnp.mean(start.positions, 0)[None]
    first, second = layout.joints.T
    controls = replace(
        controls,
        rest_angle=jnp.asarray(controls.rest_angle, dtype) + turned[second] - turned[first],
        rest_length=length,
    )
    start = with_bodies(world, start, positions)
    return Shaped(world, start, controls)


def cut(body: Shaped, present: Bool[Array, "node"]) -> Shaped:
    """Remove the absent nodes of a chain and keep its centre in place."""
    rods = grown_rods(body.world.rods, present)
    world = replace(body.world, rods=rods, present=present)
    middle = jnp.mean(body.start.positions, 0)
    positions = body.start.positions + (middle - centre(world, body.start))[None]
    lengths = jnp.asarray(body.controls.rest_length, positions.dtype)
    reach = jnp.sum(jnp.where(jnp.all(present[rods.edges], 1), lengths, 0.0))
    start = replace(body.start, positions=positions)
    return replace(body, world=world, start=start, length=reach)


def _laid_out(layout: Layout, turned: Array, length: Array) -> Float[Array, "node 2"]:
    """Return node positions relative to their mean."""
    angle = jnp.asarray(layout.angle, turned.dtype) + turned
    v = jnp.stack([cosine(angle), sine(angle)], 1) * length[:, None]
    return product(jnp.asarray(layout.placed, turned.dtype), v)
