"""Measures of what people see of a swimming body: waves, beats, its shape and its heading."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from ..archive.poses import FRAMES, STROKES
from ..portable import product, root
from ..world import Measures, World, edges_there
from .window import Window

Scalar = Float[Array, ""]

_ANGLES = 2 * np.pi * np.outer(np.arange(1, FRAMES // 2 + 1), np.arange(FRAMES)) / FRAMES
TINY = 1e-20


def kinematics(
    world: World, observed: Measures, window: Window, length: Scalar | float
) -> dict[str, Scalar]:
    """Measure the poses of a window; `length` is the body's, in cells."""
    at = window.places()
    shapes, bends = observed.positions[at], observed.curvature[at]
    moved = observed.centre[window.stop - 1] - observed.centre[jnp.maximum(window.start - 1, 0)]
    beats, wave, direction = waves(bends, along(world))
    heading, aspect = axis(shapes, moved, world.present)
    spacing = _mean_edge(world, shapes[0])
    strokes = window.strokes.astype(wave.dtype)
    swung = excursion(shapes, moved, world.present)
    distance = jnp.maximum(_norm(moved), 1e-3 * length)
    return {
        "beats": beats * strokes / STROKES,
        "wave_number": wave * length / spacing,
        "wave_direction": direction,
        "heading_angle": heading,
        "aspect": aspect,
        "strouhal": strokes * swung / distance,
    }


def along(world: World) -> Bool[Array, "pair"]:
    """Return which joints are followed, along a filament, by the next one in order."""
    joints = world.rods.joints
    if joints is None or len(joints) < 2:
        return jnp.zeros(max(0, len(world.rods.bend) - 1), bool)
    next_to = joints[:-1, 1] == joints[1:, 0]
    there = edges_there(world)
    if there is None:
        return next_to
    kept = there[joints[:, 0]] & there[joints[:, 1]]
    return next_to & kept[:-1] & kept[1:]


def waves(
    bends: Float[Array, "frame joint"], along: Bool[Array, "pair"]
) -> tuple[Scalar, Scalar, Scalar]:
    """Return beats a stroke, waves from one joint to the next, and their direction.

    Of the curvature c(t, j), less its mean over time: the mean frequency of its spectrum in
    time; and at the strongest frequency, with the amplitudes a(j), the wave number
    k = 2 atan(|Δa| / 2|a|) over 2π, with differences and means of neighbouring joints, and the
    direction −Im(a* Δa) / (|a| |Δa|): 1 for a wave that travels from the first joint to the
    last, −1 for the reverse, 0 for a standing wave.
    """
    change = bends - jnp.mean(bends, 0)[None]
    cosine = product(jnp.asarray(np.cos(_ANGLES), bends.dtype), change)
    sine = -product(jnp.asarray(np.sin(_ANGLES), bends.dtype), change)
    power = jnp.sum(cosine * cosine + sine * sine, 1)
    rates = jnp.arange(1.0, FRAMES // 2 + 1, dtype=bends.dtype) / STROKES
    beats = jnp.sum(rates * power) / jnp.maximum(jnp.sum(power), TINY)
    strongest = jnp.argmax(jax.lax.stop_gradient(power))
    real, imaginary = cosine[strongest], sine[strongest]
    middle = _middles(real, along), _middles(imaginary, along)
    change = _changes(real, along), _changes(imaginary, along)
    size, step = (root(jnp.sum(a * a + b * b) + TINY) for a, b in (middle, change))
    turned = jnp.sum(middle[0] * change[1] - middle[1] * change[0])
    moving = jnp.sum(power) > TINY
    wave = 2 * jnp.arctan2(step, 2 * size) / (2 * jnp.pi)
    zero = jnp.zeros_like(wave)
    direction = -turned / (size * step)
    return beats, jnp.where(moving, wave, zero), jnp.where(moving, direction, zero)


def axis(
    shapes: Float[Array, "frame node 2"],
    moved: Float[Array, "2"],
    present: Bool[Array, "node"] | None,
) -> tuple[Scalar, Scalar]:
    """Return the angle from the body's long axis to its path, and its width over its length.

    Both are of the second moments of its nodes about their mean, over all frames: 0 to π/2
    rad, and 0 (a line) to 1 (round).
    """
    x, y = jnp.moveaxis(_centred(shapes, present), -1, 0)
    xx, yy, xy = jnp.sum(x * x), jnp.sum(y * y), jnp.sum(x * y)
    half = jnp.sqrt((xx - yy) ** 2 / 4 + xy * xy + TINY)
    mean = (xx + yy) / 2
    aspect = jnp.sqrt(jnp.maximum(mean - half, 0.0) / (mean + half) + TINY)
    angle = jnp.arctan2(2 * xy, xx - yy + TINY) / 2
    c, s = jnp.cos(angle), jnp.sin(angle)
    ahead, aside = c * moved[0] + s * moved[1], c * moved[1] - s * moved[0]
    return jnp.arctan2(jnp.abs(aside), jnp.abs(ahead) + TINY), aspect


def excursion(
    shapes: Float[Array, "frame node 2"],
    moved: Float[Array, "2"],
    present: Bool[Array, "node"] | None,
) -> Scalar:
    """Return the largest peak-to-peak excursion of a node across the body's path, in cells."""
    x, y = jnp.moveaxis(_centred(shapes, present), -1, 0)
    across = (moved[0] * y - moved[1] * x) / _norm(moved)
    return jnp.max(jnp.max(across, 0) - jnp.min(across, 0))


def _centred(
    shapes: Float[Array, "frame node 2"], present: Bool[Array, "node"] | None
) -> Float[Array, "frame node 2"]:
    """Return positions about their mean in each frame; 0 for nodes that are absent."""
    if present is None:
        return shapes - jnp.mean(shapes, 1, keepdims=True)
    kept = present.astype(shapes.dtype)[None, :, None]
    mean = jnp.sum(shapes * kept, 1, keepdims=True) / jnp.sum(kept)
    return (shapes - mean) * kept


def _mean_edge(world: World, positions: Float[Array, "node 2"]) -> Scalar:
    edges, there = world.rods.edges, edges_there(world)
    lengths = _norm(positions[edges[:, 1]] - positions[edges[:, 0]])
    if there is None:
        return jnp.mean(lengths)
    return jnp.sum(jnp.where(there, lengths, 0.0)) / jnp.sum(there)


def _middles(a: Float[Array, "joint"], along: Bool[Array, "pair"]) -> Float[Array, "pair"]:
    return jnp.where(along, (a[:-1] + a[1:]) / 2, 0.0)


def _changes(a: Float[Array, "joint"], along: Bool[Array, "pair"]) -> Float[Array, "pair"]:
    return jnp.where(along, a[1:] - a[:-1], 0.0)


def _norm(v: Float[Array, "*batch 2"]) -> Float[Array, "*batch"]:
    return root(jnp.sum(v * v, -1) + 1e-24)
