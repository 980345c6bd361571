"""Swimming without a fluid: resistive force theory.

Each edge is a slender element whose drag across is twice that along it; a free body moves so
that force and torque vanish (Gray and Hancock, J. Exp. Biol. 32, 802 (1955); Lauga and Powers,
Rep. Prog. Phys. 72, 096601 (2009), section 5.2). Inertia, walls and other parts of the body are
left out, so speeds are rough; they serve as inputs of a model.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ...portable import cosine, sine
from .stroke import Shapes, Stroke

RATIO = 2.0
"""Drag across an element over that along it."""

Phases = Float[Array, "phase"]


class Swim(eqx.Module):
    """The motion of a free body through a stroke."""

    rigid: Float[Array, "phase 3"]
    """Velocity of the body in its own frame, in cells a step, and its rate of turn."""
    velocity: Shapes
    """Velocities of nodes in the frame of the body, in cells a step."""
    power: Phases
    """Power against a drag along the body of 1 per cell."""
    heading: Phases
    """Turn of the body's frame at each phase since the first, in rad."""
    displacement: Float[Array, "2"]
    """Displacement in the stroke, in the frame of the first phase, in cells."""
    turn: Float[Array, ""]
    """Turn in the stroke, in rad."""


def swim(stroke: Stroke, edges: Int[Array, "edge 2"], there: Float[Array, "edge"]) -> Swim:
    """Return the motion of a body; edges whose weight `there` is 0 have no drag."""
    took = stroke.took[:, None, None]
    begin, end = stroke.shapes[:, edges[:, 0]], stroke.shapes[:, edges[:, 1]]
    middle, span = 0.5 * (begin + end), end - begin
    length = jnp.sqrt(jnp.sum(span * span, 2) + 1e-12)[..., None]
    tangent, weight = span / length, length * there[None, :, None]
    deformation = stroke.changes / took
    own = 0.5 * (deformation[:, edges[:, 0]] + deformation[:, edges[:, 1]])

    def drag(velocity):
        along = jnp.sum(tangent * velocity, 2, keepdims=True)
        return weight * (RATIO * velocity - (RATIO - 1) * tangent * along)

    one, none = jnp.ones_like(middle[..., 0]), jnp.zeros_like(middle[..., 0])
    modes = [(one, none), (none, one), (-middle[..., 1], middle[..., 0])]
    modes = [jnp.stack(mode, 2) for mode in modes]
    drags = [drag(mode) for mode in modes]
    resistance = [[jnp.sum(a * b, (1, 2)) for b in drags] for a in modes]
    pushed = drag(own)
    rigid = _solved(resistance, [-jnp.sum(mode * pushed, (1, 2)) for mode in modes])
    force = pushed + sum(v[:, None, None] * f for v, f in zip(rigid, drags, strict=True))
    moved = own + sum(v[:, None, None] * mode for v, mode in zip(rigid, modes, strict=True))
    x, y = stroke.shapes[..., 0], stroke.shapes[..., 1]
    across, along, turning = (v[:, None] for v in rigid)
    carried = jnp.stack([across - turning * y, along + turning * x], 2)
    heading, displacement, turn = _path(rigid, stroke)
    return Swim(
        rigid=jnp.stack(rigid, 1),
        velocity=deformation + carried,
        power=jnp.sum(force * moved, (1, 2)),
        heading=heading,
        displacement=displacement,
        turn=turn,
    )


def _solved(a: list[list[Phases]], b: list[Phases]) -> list[Phases]:
    """Solve three equations by Cramer's rule; the matrix is positive definite."""
    (p, q, r), (_, s, t), (_, _, u) = a
    cofactors = [
        [s * u - t * t, r * t - q * u, q * t - r * s],
        [r * t - q * u, p * u - r * r, q * r - p * t],
        [q * t - r * s, q * r - p * t, p * s - q * q],
    ]
    determinant = p * cofactors[0][0] + q * cofactors[0][1] + r * cofactors[0][2]
    safe = jnp.maximum(determinant, 1e-12)
    return [(row[0] * b[0] + row[1] * b[1] + row[2] * b[2]) / safe for row in cofactors]


def _path(rigid: list[Phases], stroke: Stroke) -> tuple[Phases, Array, Array]:
    """Return heading, displacement and turn of the body's frame."""
    across, along, turning = rigid
    turned = turning * stroke.took
    after = jnp.cumsum(turned + stroke.turns)
    heading = jnp.concatenate([jnp.zeros_like(after[:1]), after[:-1]])
    middle = heading + turned / 2
    c, s = cosine(middle), sine(middle)
    x = jnp.sum((c * across - s * along) * stroke.took)
    y = jnp.sum((s * across + c * along) * stroke.took)
    return heading, jnp.stack([x, y]), after[-1]
