"""Measures of a creature's motion; `microcosmos.measures` is the table of all.

Waves, beats, shape and heading are measured from the recorded poses, the others at every step.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from .. import units
from ..archive.poses import FRAMES, STROKES
from ..filaments import Rest
from ..measures import RECORDED as MEASURES
from ..portable import product, root
from ..world import (
    Measures,
    Route,
    State,
    World,
    mean,
    present_edges,
    present_joints,
    route,
    together,
    unwrapped,
)
from .window import Window

Scalar = Float[Array, ""]

_ANGLES = 2 * np.pi * np.outer(np.arange(1, FRAMES // 2 + 1), np.arange(FRAMES)) / FRAMES
TINY = 1e-20


def kinematics(
    world: World, observed: Measures, path: Route, window: Window, length: Scalar | float
) -> dict[str, Scalar]:
    """Measure the poses of a window; `length` is the body's, in cells."""
    at = window.places()
    shapes = together(world, observed.positions[at], observed.boxes[at])
    bends = observed.curvature[at]
    moved = path.way(jnp.maximum(window.start, 1), window.stop)
    beats, wave, direction = waves(bends, along(world))
    heading, aspect = axis(shapes, moved, world.present)
    spacing = _mean_edge(world, shapes[0])
    strokes = window.strokes.astype(wave.dtype)
    swung = excursion(shapes, moved, world.present)
    distance = jnp.maximum(_portable_norm(moved), 1e-3 * length)
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
    grown = present_edges(world)
    if grown is None:
        return next_to
    kept = grown[joints[:, 0]] & grown[joints[:, 1]]
    return next_to & kept[:-1] & kept[1:]


def waves(
    bends: Float[Array, "frame joint"], along: Bool[Array, "pair"]
) -> tuple[Scalar, Scalar, Scalar]:
    """Return beats a stroke, waves from one joint to the next, and their direction.

    The curvature c(t, j) counts less its mean over time. Beats are the mean frequency of its
    spectrum in time. At the strongest frequency, with the amplitudes a(j), the wave number is
    k = 2 atan(|Δa| / 2|a|) over 2π, with differences and means of neighbouring joints, and the
    direction is −Im(a* Δa) / (|a| |Δa|): 1 for a wave that travels from the first joint to the
    last, −1 for the reverse, 0 for a standing wave.
    """
    change = bends - jnp.mean(bends, 0)[None]
    cosine = product(jnp.asarray(np.cos(_ANGLES), bends.dtype), change)
    sine = -product(jnp.asarray(np.sin(_ANGLES), bends.dtype), change)
    power = jnp.sum(cosine * cosine + sine * sine, 1)
    rates = jnp.arange(1.0, FRAMES // 2 + 1, dtype=bends.dtype) / STROKES
    beats = jnp.sum(rates * power) / jnp.maximum(jnp.sum(power), TINY)
    # The choice of a frequency has no derivative.
    strongest = jnp.argmax(jax.lax.stop_gradient(power))
    real, imaginary = cosine[strongest], sine[strongest]
    size, step, turned = along_joints(real, imaginary, along)
    moving = jnp.sum(power) > TINY
    wave = 2 * jnp.arctan2(step, 2 * size) / (2 * jnp.pi)
    zero = jnp.zeros_like(wave)
    direction = -turned / (size * step)
    return beats, jnp.where(moving, wave, zero), jnp.where(moving, direction, zero)


def along_joints(
    real: Float[Array, "joint"], imaginary: Float[Array, "joint"], along: Bool[Array, "pair"]
) -> tuple[Scalar, Scalar, Scalar]:
    """Return |a| and |Δa| of complex amplitudes a, and −|a| |Δa| times a wave's direction."""
    middle = [jnp.where(along, (a[:-1] + a[1:]) / 2, 0.0) for a in (real, imaginary)]
    change = [jnp.where(along, a[1:] - a[:-1], 0.0) for a in (real, imaginary)]
    size, step = (root(jnp.sum(a * a + b * b) + TINY) for a, b in (middle, change))
    return size, step, jnp.sum(middle[0] * change[1] - middle[1] * change[0])


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
    across = (moved[0] * y - moved[1] * x) / _portable_norm(moved)
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
    edges, grown = world.rods.edges, present_edges(world)
    lengths = _portable_norm(positions[edges[:, 1]] - positions[edges[:, 0]])
    if grown is None:
        return jnp.mean(lengths)
    return jnp.sum(jnp.where(grown, lengths, 0.0)) / jnp.sum(grown)


def _portable_norm(v: Float[Array, "*batch 2"]) -> Float[Array, "*batch"]:
    return root(jnp.sum(v * v, -1) + 1e-24)


MOTION = MEASURES[:6]
"""Measures of the motion alone."""

Curvature = Float[Array, "time joint"]


def observe(state: State, measures: Measures) -> Measures:
    """Return the measures of a step."""
    return measures


def motion(
    world: World,
    start: State,
    end: State,
    observed: Measures,
    path: Route,
    length: Scalar | float,
) -> dict[str, Any]:
    """Measure a motion; `observed` has time first, `length` is the body's, in cells."""
    steps = len(observed.node_speed)
    displacement = _norm(path.way(0, -1))
    travelled = jnp.sum(_norm(path.way(slice(None, -1), slice(1, None))))
    edges, joints = present_edges(world), present_joints(world)
    power = jnp.mean(observed.power)
    nodes = len(start.positions) if world.present is None else jnp.sum(world.present)
    heading = jnp.concatenate([mean(start.angles, edges)[None], observed.heading])
    curved, spread = curvature(observed.curvature, joints)
    return {
        "displacement": displacement,
        "bending_effort": effort(observed.rest.angle, joints),
        "stretching_effort": effort(observed.rest.length, edges),
        "path_length": travelled,
        "straightness": displacement / jnp.maximum(travelled, 1e-12),
        "rotation": mean(end.angles - start.angles, edges),
        "energy": jnp.zeros(()) if end.collected is None else jnp.sum(end.collected),
        "mach": units.mach(jnp.max(observed.speed)),
        "limited": jnp.mean(observed.held),
        "reynolds": units.reynolds(jnp.mean(observed.node_speed), length, world.viscosity),
        "mean_speed": travelled / steps,
        "turning": jnp.sum(jnp.abs(jnp.diff(heading))),
        "curvature_mean": curved,
        "curvature_spread": spread,
        "symmetry": symmetry(observed.curvature, joints),
        "power": power,
        "efficiency": efficiency(displacement / steps, power, world.viscosity),
        "nodes": jnp.asarray(nodes),
        "impulse": impulse(observed.force),
    }


def swimming(
    path: Float[Array, "time 2"], strokes: Float[Array, "time"], length: Scalar | float
) -> tuple[Scalar, Scalar]:
    """Return speed, in lengths in 1,000 steps, and stride, in lengths a stroke.

    Both are over whole strokes after the first, which starts from rest: `path` and `strokes`
    are the body's centre and the strokes done after each step. Both are 0 below two strokes.
    """
    moved, took, count = _stroked(path, strokes)
    distance = _norm(moved) / length
    zero = jnp.zeros_like(distance)
    return (
        jnp.where(count > 0, 1000 * distance / took, zero),
        jnp.where(count > 0, distance / jnp.maximum(count, 1.0), zero),
    )


def advance(
    path: Float[Array, "time 2"], strokes: Float[Array, "time"], length: Scalar | float
) -> Scalar:
    """Return the speed along x, in lengths in 1,000 steps, over the same strokes; it is
    negative along −x."""
    moved, took, count = _stroked(path, strokes)
    return jnp.where(count > 0, 1000 * moved[0] / length / took, jnp.zeros_like(took))


def _stroked(
    path: Float[Array, "time 2"], strokes: Float[Array, "time"]
) -> tuple[Float[Array, "2"], Scalar, Scalar]:
    """Return the displacement over whole strokes after the first, their time in steps and
    their number, 0 below two strokes."""
    times = jnp.arange(1.0, len(path) + 1, dtype=path.dtype)
    # The clock adds up rounding: a stroke that lacks a thousandth is complete. A count has no
    # derivative.
    done = jax.lax.stop_gradient(jnp.floor(strokes[-1] + 1e-3))
    ends = jnp.stack([jnp.ones_like(done), jnp.maximum(done, 2.0)])
    moved = [jnp.diff(jnp.interp(ends, strokes, path[:, axis]))[0] for axis in (0, 1)]
    took = jnp.maximum(jnp.diff(jnp.interp(ends, strokes, times))[0], 1.0)
    return jnp.stack(moved), took, jnp.where(done >= 2, done - 1, jnp.zeros_like(done))


def cost_of_transport(
    path: Float[Array, "moment 2"],
    observed: Measures,
    strokes: Float[Array, "time"],
    length: Scalar | float,
) -> Scalar:
    """Return the work on the fluid per length of the body that its centre moves along `path`,
    which begins before the first step.

    Over whole strokes after the first; over the whole simulation if there are fewer than two.
    A distance below a thousandth of the length counts as that.
    """
    work = jnp.concatenate([jnp.zeros(1, strokes.dtype), jnp.cumsum(observed.power)])
    done = jax.lax.stop_gradient(jnp.floor(strokes[-1] + 1e-3))
    ends = jnp.where(done >= 2, jnp.stack([jnp.ones_like(done), done]), jnp.zeros(2))
    since = jnp.concatenate([jnp.zeros(1, strokes.dtype), strokes])
    steps = jnp.arange(0.0, len(since), dtype=strokes.dtype)
    at = jnp.interp(ends, since, steps)
    at = jnp.where(done >= 2, at, jnp.stack([steps[0], steps[-1]]))
    spent = jnp.diff(jnp.interp(at, steps, work))[0]
    moved = [jnp.diff(jnp.interp(at, steps, path[:, axis]))[0] for axis in (0, 1)]
    return spent / jnp.maximum(_norm(jnp.stack(moved)) / length, 1e-3)


def impulse(force: Float[Array, "time group 2"]) -> Scalar:
    """Return the largest net momentum that a body has given to the fluid at any time."""
    return jnp.max(_norm(jnp.cumsum(force, 0)))


def effort(rest: Float[Array, "time item"], kept: Bool[Array, "item"] | None = None) -> Scalar:
    """Sum over time and items the squared change from one step to the next."""
    changes = jnp.diff(rest, axis=0) ** 2
    return jnp.sum(changes if kept is None else jnp.where(kept[None], changes, 0.0))


def curvature(
    bends: Curvature, kept: Bool[Array, "joint"] | None = None
) -> tuple[Scalar, Scalar]:
    """Return mean and standard deviation of |curvature| over time and joints, 1/cells.

    Both are 0 without joints.
    """
    if bends.shape[1] == 0:
        return jnp.zeros((), bends.dtype), jnp.zeros((), bends.dtype)
    size = jnp.abs(bends)
    average = jnp.mean(mean(size.T, kept))
    squares = jnp.mean(mean((size.T - average) ** 2, kept))
    return average, jnp.sqrt(squares + 1e-24)


def symmetry(bends: Curvature, kept: Bool[Array, "joint"] | None = None) -> Scalar:
    """Correlate the joints' bending with its mirror along the body, −1 to 1.

    Σ c(t, j) c(t, J − 1 − j) / Σ c(t, j)², with the curvature c less its mean over time.
    1: both halves bend alike at all times, like a jellyfish; −1: they bend oppositely, in S
    shapes; about 0: a wave runs along the body. Joints that are present count in their
    order, which is that along a filament.
    """
    change = bends - jnp.mean(bends, 0)[None]
    joints = bends.shape[1]
    mirror = jnp.arange(joints)[::-1]
    if kept is not None:
        order, rank = jnp.argsort(~kept, stable=True), jnp.cumsum(kept) - 1
        mirror = order[jnp.mod(jnp.sum(kept) - 1 - rank, joints)]
    mirrored = change * change[:, mirror]
    square = change * change
    if kept is not None:
        mirrored = jnp.where(kept[None], mirrored, 0.0)
    return jnp.sum(mirrored) / jnp.maximum(jnp.sum(square), 1e-20)


def efficiency(speed: Scalar, power: Scalar, viscosity: Scalar) -> Scalar:
    """Return ν U² / P: the power to drag a unit resistance over the power spent.

    It is 0 where the total power is not positive, and NaN where the power is.
    """
    # The divisor is chosen too: the branch that is not taken has a derivative, which must not
    # be NaN.
    spent = ~(power <= 1e-20)
    return jnp.where(spent, viscosity * speed**2 / jnp.where(spent, power, 1.0), 0.0)


def _norm(v: Float[Array, "*batch 2"]) -> Float[Array, "*batch"]:
    return jnp.sqrt(jnp.sum(v * v, -1) + 1e-24)


class Motion(eqx.Module):
    """The motion of one creature; moments are its start and the end of every step."""

    path: Float[Array, "moment 2"]
    """Mean position of its nodes, in cells, not wrapped around the world."""
    heading: Float[Array, "moment"]
    """Mean direction of its edges, in rad."""
    rest: Rest
    """Rest shapes of each step: `angle` (time, joint) in rad, `length` (time, edge)."""
    curvature: Float[Array, "time joint"]
    """In 1/cells."""
    node_speed: Float[Array, "time"]
    """Mean speed of nodes, in cells a step."""
    power: Float[Array, "time"]
    """Power spent on the fluid."""
    middle: Float[Array, "moment 2"]
    """Position of the middle node, of those that have grown and in their order, in cells; of
    the first of several copies."""
    start: Float[Array, "node 2"]
    """Positions of nodes at the start, in cells."""
    end: Float[Array, "node 2"]
    viscosity: Scalar
    measures: dict[str, Scalar]
    """The usual measures, by name."""

    def __getattr__(self, name: str) -> Any:
        # Authors of plug-ins read this; the usual error names no field that there is.
        known = ", ".join(field.name for field in fields(type(self)))
        raise AttributeError(f"a motion has {known}, got {name!r}")


@dataclass(frozen=True)
class Measure:
    """A measure that a spec names, built in or of a plug-in, beside those of every motion."""

    name: str
    of: Callable[[Motion], Scalar]


def recorded_motion(
    world: World,
    start: State,
    end: State,
    observed: Measures,
    measures: dict[str, Any],
    copies: int,
) -> Motion:
    """Return a simulation in the form that named measures take.

    Positions are unwrapped: in cells from the corner of the first box.
    """
    first, begun = mean(start.angles, present_edges(world)), unwrapped(world, start)
    nodes = len(start.positions) // copies
    node = middle_node(nodes, None if world.present is None else world.present[:nodes])
    return Motion(
        path=route(world, start, observed).places,
        heading=jnp.concatenate([first[None], observed.heading]),
        rest=observed.rest,
        curvature=observed.curvature,
        node_speed=observed.node_speed,
        power=observed.power,
        middle=jnp.concatenate([begun[node][None], unwrapped(world, observed)[:, node]]),
        start=begun,
        end=unwrapped(world, end),
        viscosity=world.viscosity,
        measures=measures,
    )


def middle_node(nodes: int, present: Bool[Array, "node"] | None) -> int | Int[Array, ""]:
    """Return the number of the middle one among the nodes that have grown, in their order."""
    if present is None:
        return nodes // 2
    # Absent nodes go behind the others, which keep their order.
    return jnp.argsort(~present, stable=True)[jnp.sum(present) // 2]
