"""Measures of a creature's motion; names, units and axes are in `spec.measures`."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, get_args

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .. import units
from ..filaments import Rest
from ..naming import MeasureName
from ..world import Measures, State, World, centre, edges_there, joints_there, mean

MEASURES: tuple[str, ...] = get_args(MeasureName)
"""Measures of every elite, in this order; units in `docs/formats.md`."""

MOTION = MEASURES[:6]
"""Measures of the motion alone."""

Curvature = Float[Array, "time joint"]
Scalar = Float[Array, ""]


def observe(state: State, measures: Measures) -> Measures:
    """Return the measures of a step."""
    return measures


def motion(
    world: World, start: State, end: State, observed: Measures, length: Scalar | float
) -> dict[str, Any]:
    """Measure a motion; `observed` has time first, `length` is the body's, in cells."""
    first, steps = centre(world, start), len(observed.node_speed)
    moved = jnp.diff(jnp.concatenate([first[None], observed.centre]), axis=0)
    displacement, path = _norm(observed.centre[-1] - first), jnp.sum(_norm(moved))
    edges, joints = edges_there(world), joints_there(world)
    power = jnp.mean(observed.power)
    nodes = len(start.positions) if world.present is None else jnp.sum(world.present)
    heading = jnp.concatenate([mean(start.angles, edges)[None], observed.heading])
    curved, spread = curvature(observed.curvature, joints)
    return {
        "displacement": displacement,
        "bending_effort": effort(observed.rest.angle, joints),
        "stretching_effort": effort(observed.rest.length, edges),
        "path_length": path,
        "straightness": displacement / jnp.maximum(path, 1e-12),
        "rotation": mean(end.angles - start.angles, edges),
        "energy": jnp.zeros(()) if end.collected is None else jnp.sum(end.collected),
        "mach": units.mach(jnp.max(observed.speed)),
        "limited": jnp.mean(observed.held),
        "reynolds": units.reynolds(jnp.mean(observed.node_speed), length, world.viscosity),
        "mean_speed": path / steps,
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
    done = jax.lax.stop_gradient(jnp.floor(strokes[-1] + 1e-3))
    ends = jnp.stack([jnp.ones_like(done), jnp.maximum(done, 2.0)])
    moved = [jnp.diff(jnp.interp(ends, strokes, path[:, axis]))[0] for axis in (0, 1)]
    took = jnp.maximum(jnp.diff(jnp.interp(ends, strokes, times))[0], 1.0)
    return jnp.stack(moved), took, jnp.where(done >= 2, done - 1, jnp.zeros_like(done))


def cost_of_transport(
    start: Float[Array, "2"],
    observed: Measures,
    strokes: Float[Array, "time"],
    length: Scalar | float,
) -> Scalar:
    """Return the work on the fluid per length of the body that its centre moves.

    Over whole strokes after the first; over the whole simulation if there are fewer than two.
    A distance below a thousandth of the length counts as that.
    """
    work = jnp.concatenate([jnp.zeros(1, strokes.dtype), jnp.cumsum(observed.power)])
    path = jnp.concatenate([start[None], observed.centre])
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
    found: Curvature, kept: Bool[Array, "joint"] | None = None
) -> tuple[Scalar, Scalar]:
    """Return mean and standard deviation of |curvature| over time and joints, 1/cells.

    Both are 0 without joints.
    """
    if found.shape[1] == 0:
        return jnp.zeros((), found.dtype), jnp.zeros((), found.dtype)
    size = jnp.abs(found)
    average = jnp.mean(mean(size.T, kept))
    squares = jnp.mean(mean((size.T - average) ** 2, kept))
    return average, jnp.sqrt(squares + 1e-24)


def symmetry(found: Curvature, kept: Bool[Array, "joint"] | None = None) -> Scalar:
    """Correlate the joints' bending with its mirror along the body, −1 to 1.

    Σ c(t, j) c(t, J − 1 − j) / Σ c(t, j)², with the curvature c less its mean over time.
    1: both halves bend alike at all times, like a jellyfish; −1: they bend oppositely, in S
    shapes; about 0: a wave runs along the body. Joints that are present count in their
    order, which is that along a filament.
    """
    change = found - jnp.mean(found, 0)[None]
    joints = found.shape[1]
    mirror = jnp.arange(joints)[::-1]
    if kept is not None:
        order, rank = jnp.argsort(~kept, stable=True), jnp.cumsum(kept) - 1
        mirror = order[jnp.mod(jnp.sum(kept) - 1 - rank, joints)]
    product = change * change[:, mirror]
    square = change * change
    if kept is not None:
        product = jnp.where(kept[None], product, 0.0)
    return jnp.sum(product) / jnp.maximum(jnp.sum(square), 1e-20)


def efficiency(speed: Scalar, power: Scalar, viscosity: Scalar) -> Scalar:
    """Return ν U² / P: the power to drag a unit resistance over the power spent.

    It is 0 where the total power is not positive.
    """
    spent = power > 1e-20
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
    start: Float[Array, "node 2"]
    """Positions of nodes at the start, in cells."""
    end: Float[Array, "node 2"]
    viscosity: Scalar
    measures: dict[str, Scalar]
    """The usual measures, by the names of `spec.measures`."""

    def __getattr__(self, name: str) -> Any:
        known = ", ".join(field.name for field in fields(type(self)))
        raise AttributeError(f"a motion has {known}, got {name!r}")


@dataclass(frozen=True)
class Measure:
    """A measure of a plug-in, beside the usual ones."""

    name: str
    of: Callable[[Motion], Scalar]


def motion_for_plugins(
    world: World, start: State, end: State, observed: Measures, measures: dict[str, Any]
) -> Motion:
    """Return a simulation in the form that measures of plug-ins take."""
    first = mean(start.angles, edges_there(world))
    return Motion(
        path=jnp.concatenate([centre(world, start)[None], observed.centre]),
        heading=jnp.concatenate([first[None], observed.heading]),
        rest=observed.rest,
        curvature=observed.curvature,
        node_speed=observed.node_speed,
        power=observed.power,
        start=start.positions,
        end=end.positions,
        viscosity=world.viscosity,
        measures=measures,
    )
