"""Shape matching: fit the whole rest shape of a body to where the fluid carried its nodes.

The method is that of Müller, Heidelberger, Teschner and Gross, ACM Trans. Graph. 24, 471
(2005), in the plane and with equal masses. Sweeps of constraints with stiffness 1 converge to
the same shape; in closed form no zigzag is left, and the shape does not depend on spacing,
sweeps or step. The fit keeps the mean position and the angular momentum of the displacements.
"""

import equinox as eqx
import jax.numpy as jnp
from jax.lax import Precision
from jaxtyping import Array, Bool, Float, Int

from ..groups import Groups
from .projection import Angles, Positions, Rest, Rods, wrap


class Layout(eqx.Module):
    """The forward kinematics of bodies, see `bodies.Layout`.

    Bodies of one size may have a matrix each, with the body as first axis; edges and nodes then
    stand body by body.
    """

    angle: Float[Array, "edge"]
    rest_angle: Float[Array, "joint"]
    turned: Float[Array, "*body _ _"]
    placed: Float[Array, "*body _ _"]
    pieces: Groups
    """The connected piece of each node."""
    bends: Bool[Array, "joint"] | None = None
    """Joints that have grown; None: all."""
    bend: Float[Array, "joint"] | None = None
    """Share of a joint's error that a step removes; None: all of it."""


def turns(rest: Rest, layout: Layout) -> Float[Array, "*time edge"]:
    """Return the turn of each edge from the unchanged body, in rad; their mean is 0."""
    straight = jnp.broadcast_to(layout.rest_angle, rest.angle.shape)
    return _product(rest.angle - straight, layout.turned)


def rest_positions(rest: Rest, layout: Layout) -> Float[Array, "*time node 2"]:
    """Return the positions of nodes in rest shapes, relative to the middle of each piece."""
    turned = turns(rest, layout)
    angle = turned + jnp.broadcast_to(layout.angle, turned.shape)
    x, y = (
        _product(rest.length * along, layout.placed)
        for along in (jnp.cos(angle), jnp.sin(angle))
    )
    return jnp.stack([x, y], -1)


def standing(positions: Positions, angles: Angles, rods: Rods, layout: Layout) -> Rest:
    """Return the rest shape in which a body stands; angles near the layout's rest angles."""
    assert rods.joints is not None
    first, second = rods.joints.T
    turned = wrap(angles[second] - angles[first] - layout.rest_angle)
    v = positions[rods.edges[:, 1]] - positions[rods.edges[:, 0]]
    # The constant keeps the root differentiable where two nodes coincide.
    return Rest(layout.rest_angle + turned, jnp.sqrt(jnp.sum(v * v, 1) + 1e-24))


def softened(rest: Rest, angles: Angles, joints: Int[Array, "joint 2"], layout: Layout) -> Rest:
    """Return the rest shape towards which soft joints turn in a step.

    A step removes the share `layout.bend` of a joint's error, so the error decays exponentially
    in a fluid at rest. `angles` are those of the edges that the fluid has carried, in rad.
    """
    if layout.bend is None:
        return rest
    first, second = joints.T
    error = wrap(angles[second] - angles[first] - rest.angle)
    return Rest(rest.angle + (1 - layout.bend) * error, rest.length)


def matched(
    positions: Positions, rest: Rest, layout: Layout, present: Bool[Array, "node"] | None = None
) -> Positions:
    """Return the rest shape, moved and turned to be nearest to `positions`."""
    return fitted(rest_positions(rest, layout), positions, layout.pieces, present)


def fitted(
    shape: Positions,
    positions: Positions,
    pieces: Groups,
    present: Bool[Array, "node"] | None = None,
) -> Positions:
    """Return each piece of a shape, moved and turned to be nearest to `positions`.

    Nodes that are not `present` have no weight; they move with the others.
    """
    ones = jnp.ones_like(shape[:, 0])
    # Absent nodes stay in the sums with weight 0: shapes of arrays must not depend on growth.
    weight = ones if present is None else ones * present

    def middle(x):
        return pieces.per_node(pieces.mean(x, weight))

    centre = middle(positions)
    arms, goal = positions - centre, shape - middle(shape)
    x, y = goal.T
    cosine = pieces.total(weight * (x * arms[:, 0] + y * arms[:, 1]))
    sine = pieces.total(weight * (x * arms[:, 1] - y * arms[:, 0]))
    # A piece of one node has no direction: the constant keeps the division finite.
    size = jnp.sqrt(cosine**2 + sine**2 + 1e-24)
    c, s = pieces.per_node(cosine / size), pieces.per_node(sine / size)
    return centre + jnp.stack([c * x - s * y, s * x + c * y], 1)


def _product(values, matrix: Float[Array, "*body out in"]):
    """Apply a matrix to the last axis, at full precision also on a GPU."""
    if matrix.ndim == 2:
        return jnp.matmul(values, matrix.T, precision=Precision.HIGHEST)
    each = values.reshape(*values.shape[:-1], len(matrix), matrix.shape[2])
    found = jnp.einsum("...bi,boi->...bo", each, matrix, precision=Precision.HIGHEST)
    return found.reshape(*values.shape[:-1], -1)
