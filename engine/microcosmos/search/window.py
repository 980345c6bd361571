"""The last two strokes of a simulation, and the poses that are recorded of them."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from ..archive.poses import FRAMES, LEVELS, MOMENTS, STROKES

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
    done = jnp.floor(jax.lax.stop_gradient(strokes[-1]) + 1e-3)
    whole = done >= STROKES
    times = jnp.arange(1.0, count + 1, dtype=strokes.dtype)
    at = jnp.interp(jnp.stack([done - STROKES, done]), strokes, times)
    # The first step may be the first of the window, before which no stroke was interpolated.
    start = jnp.where(done == STROKES, 0.0, at[0])
    start, stop = jnp.rint(start).astype(jnp.int32), jnp.rint(at[1]).astype(jnp.int32)
    return Window(
        start=jnp.where(whole, start, 0),
        stop=jnp.where(whole, stop, count),
        strokes=jnp.where(whole, STROKES, 0),
    )


class Poses(eqx.Module):
    """Recorded poses of one creature or of a block; see `archive.poses.PoseStream`."""

    positions: Int[Array, "*block frame node 2"]
    path: Float[Array, "*block moment 2"]
    origin: Float[Array, "*block 2"]
    scale: Scalar
    window: Window
    length: Scalar
    present: Bool[Array, "*block node"]
    edges: Int[Array, "*block edge 2"]


def poses(
    start: Float[Array, "2"],
    centre: Float[Array, "time 2"],
    positions: Float[Array, "time node 2"],
    present: Bool[Array, "node"],
    edges: Int[Array, "edge 2"],
    window: Window,
    length: Scalar | float,
) -> Poses:
    """Record the poses of a simulation whose centre was at `start` before the first step."""
    dtype = positions.dtype
    shown = positions[window.places()]
    there = present[None, :, None]
    low = jnp.min(jnp.where(there, shown, jnp.inf), (0, 1))
    high = jnp.max(jnp.where(there, shown, -jnp.inf), (0, 1))
    origin = (low + high) / 2
    scale = jnp.maximum(jnp.max(high - low) / 2, 1e-6) / LEVELS
    units = jnp.clip(jnp.rint((shown - origin[None, None]) / scale), -LEVELS, LEVELS)
    whole = jnp.concatenate([start[None], centre])
    moments = (2 * jnp.arange(MOMENTS) * len(centre) + MOMENTS - 1) // (2 * (MOMENTS - 1))
    return Poses(
        positions=jnp.where(there, units, 0.0).astype(jnp.int16),
        path=whole[moments],
        origin=origin,
        scale=scale,
        window=window,
        length=jnp.asarray(length, dtype),
        present=present,
        edges=jnp.asarray(edges, jnp.int32),
    )
