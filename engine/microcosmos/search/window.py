"""The last two strokes of a simulation, the poses recorded of them, and filaments that cross.

Filaments that pass through each other are impossible in a plane. The native kernel records
poses too, with measures and status (`summarise`).
"""

from collections.abc import Sequence
from math import ceil
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from ..archive.poses import FRAMES, LEVELS, MOMENTS, STROKES
from ..measures import SUMMARISED
from ..world import Measures, State, World, grown_nodes, native

Scalar = Float[Array, "*block"]
Count = Int[Array, "*block"]


class Window(eqx.Module):
    """The last two whole strokes; the whole simulation if it has fewer."""

    start: Count
    """Steps before it."""
    stop: Count
    """Steps at its end."""
    strokes: Count
    """2, or 0 if the creature completed fewer."""

    def places(self) -> Int[Array, "frame"]:
        """Return the steps, from 0, after which poses are recorded: at equal times."""
        passed = jnp.arange(1, FRAMES + 1) * (self.stop - self.start)
        done = self.start + (2 * passed + FRAMES) // (2 * FRAMES)
        return jnp.maximum(done, 1) - 1


def window(strokes: Float[Array, "time"]) -> Window:
    """Return the window, from the strokes done at the end of each step."""
    count = len(strokes)
    # The same margin as in `measures`, so that both take the same strokes.
    done = jnp.floor(jax.lax.stop_gradient(strokes[-1]) + 1e-3)
    whole = done >= STROKES
    times = jnp.arange(1.0, count + 1, dtype=strokes.dtype)
    at = jnp.interp(jnp.stack([done - STROKES, done]), strokes, times)
    # The first step may be the first of the window, before which no stroke was interpolated.
    start = jnp.where(done == STROKES, 0.0, at[0])
    # Halves are rounded up, as in the kernel; `rint` would take the even one.
    start, stop = (jnp.floor(one + 0.5).astype(jnp.int32) for one in (start, at[1]))
    return Window(
        start=jnp.where(whole, start, 0),
        stop=jnp.where(whole, stop, count),
        strokes=jnp.where(whole, STROKES, 0),
    )


class Poses(eqx.Module):
    """Recorded poses of one creature or of a block; see `archive.poses.PoseStream`."""

    positions: Int[Array, "*block frame node 2"]
    path: Float[Array, "*block moment 2"]
    middles: Float[Array, "*block frame 2"]
    scale: Scalar
    window: Window
    length: Scalar
    present: Bool[Array, "*block node"]
    edges: Int[Array, "*block edge 2"]


def poses(
    path: Float[Array, "step 2"],
    frames: Float[Array, "frame node 2"],
    corners: Float[Array, "frame 2"],
    present: Bool[Array, "node"],
    edges: Int[Array, "edge 2"],
    window: Window,
    length: Scalar | float,
) -> Poses:
    """Record the poses of a simulation.

    `path` is that of the centre, before the first step and after each. `frames` are positions
    at `window.places()` from `corners` near the body, so that far places are not rounded.
    """
    dtype = frames.dtype
    grown = present[None, :, None]
    low = jnp.min(jnp.where(grown, frames, jnp.inf), 1)
    high = jnp.max(jnp.where(grown, frames, -jnp.inf), 1)
    middles = (low + high) / 2
    scale = jnp.maximum(jnp.max(high - low) / 2, 1e-6) / LEVELS
    units = jnp.clip(jnp.rint((frames - middles[:, None]) / scale), -LEVELS, LEVELS)
    steps = len(path) - 1
    moments = (2 * jnp.arange(MOMENTS) * steps + MOMENTS - 1) // (2 * (MOMENTS - 1))
    return Poses(
        positions=jnp.where(grown, units, 0.0).astype(jnp.int16),
        path=path[moments],
        middles=corners + middles,
        scale=scale,
        window=window,
        length=jnp.asarray(length, dtype),
        present=present,
        edges=jnp.asarray(edges, jnp.int32),
    )


MOST_PAIRS = 2**23
"""Most pairs of edges over all poses: of larger bodies only every second, third ... pose
counts."""
COARSER = 4
"""Recorded levels in a unit of place: products of differences then fit 32 bits, so signs are
exact."""


def crossing(recorded: Poses, start: Float[Array, "node 2"]) -> Float[Array, ""]:
    """Return the share of recorded poses in which two edges cross that do not at the start."""
    size, frames = len(recorded.edges), len(recorded.positions)
    step = min(frames, ceil(frames * size**2 / MOST_PAIRS)) or 1
    pairs = _apart(recorded) & ~_crossed(whole_units(start), recorded.edges)
    positions = recorded.positions[step - 1 :: step].astype(jnp.int32) // COARSER
    crosses = jax.lax.map(lambda at: jnp.any(_crossed(at, recorded.edges) & pairs), positions)
    return jnp.mean(crosses.astype(recorded.scale.dtype))


def _apart(recorded: Poses) -> Bool[Array, "edge edge"]:
    """Return which pairs of edges are present and share no node; each pair once."""
    first, second = recorded.edges.T
    shared = [
        one[:, None] == other[None] for one in (first, second) for other in (first, second)
    ]
    present = recorded.present[first] & recorded.present[second]
    lower = jnp.asarray(np.tri(len(first), k=-1, dtype=bool))
    return lower & present[:, None] & present[None] & ~jnp.any(jnp.stack(shared), 0)


def whole_units(points: Float[Array, "node 2"]) -> Int[Array, "node 2"]:
    """Return places about their mean in whole units, as fine as those of recorded poses."""
    middle = points - points.mean(0, keepdims=True)
    most = LEVELS // COARSER
    return jnp.rint(middle * (most / jnp.max(jnp.abs(middle)))).astype(jnp.int32)


def _crossed(at: Int[Array, "node 2"], edges: Int[Array, "edge 2"]) -> Bool[Array, "edge edge"]:
    """Return which edges lie across each other: the ends of each on both sides of the other."""
    base, tip = at[edges[:, 0]], at[edges[:, 1]]

    def side(points: Int[Array, "edge 2"]) -> Int[Array, "edge edge"]:
        """Return the sign of each point's side of each edge."""
        along, away = (tip - base)[:, None], points[None] - base[:, None]
        return jnp.sign(along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0])

    divides = side(base) * side(tip) < 0
    return divides & divides.T


SHOWN = 5
"""Numbers beside the measures: the scale of the poses, the window, the status."""


def summarise(
    world: World,
    start: State,
    end: State,
    observed: Measures,
    clock: Float[Array, "time"],
    period: float | None,
    length: Float[Array, ""] | float,
    instruction_set: str | None = None,
) -> tuple[dict[str, Float[Array, ""]], Poses, Int[Array, ""]]:
    """Return measures by name, the pose stream, and the status of a motion.

    `clock` is the controller's time at the end of each step, `period` the steps in a stroke,
    `length` the body's, in cells. The measures are those of `evaluation.motion_of`, with sums
    in double precision.
    """
    target = native.register("summarise", instruction_set)
    shapes = _results(len(start.positions))
    operands, sizes = _operands(world, start, end, observed)
    scales = [world.viscosity, length, period or 0.0]
    operands += [clock, jnp.stack([jnp.asarray(one, jnp.float32) for one in scales])]
    places, frames, middles, scalars, measures = native.call(target, shapes, operands, sizes)
    begun, stop, strokes, status = scalars[1:].astype(jnp.int32)
    recorded = Poses(
        positions=frames.astype(jnp.int16),
        path=places,
        middles=middles,
        scale=scalars[0],
        window=Window(begun, stop, strokes),
        length=jnp.asarray(length, jnp.float32),
        present=grown_nodes(world),
        edges=jnp.asarray(world.rods.edges, jnp.int32),
    )
    return dict(zip(SUMMARISED, measures, strict=True)), recorded, status


def _results(nodes: int) -> Sequence[tuple[int, ...]]:
    return [(MOMENTS, 2), (FRAMES, nodes, 2), (FRAMES, 2), (SHOWN,), (len(SUMMARISED),)]


def _operands(
    world: World, start: State, end: State, observed: Measures
) -> tuple[list[Any], dict[str, int]]:
    rods, (height, width) = world.rods, world.size
    collected = end.collected
    graph = (rods.edges, rods.joints, world.groups.member, grown_nodes(world))
    around, features = native.surroundings_of(world)
    operands = [
        *end.populations,
        *around[:4],  # Forces and walls.
        start.positions,
        start.angles,
        *(jnp.asarray(one, jnp.int32) for one in graph),
        start.boxes,
        jnp.zeros(0, jnp.float32) if collected is None else collected,
        observed.rest.angle,
        observed.rest.length,
        *(getattr(observed, name) for name in native.OBSERVED),
    ]
    sizes = {
        "height": height,
        "width": width,
        "steps": len(observed.power),
        "nodes": len(start.positions),
        "edges": len(rods.edges),
        "joints": len(rods.bend),
        "bodies": world.groups.count,
        "energetic": collected is not None,
        **{name: features[name] for name in ("driven", "varied", "walled")},
    }
    return operands, sizes
