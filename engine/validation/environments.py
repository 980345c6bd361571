"""Boxes that specs describe: obstacles and flows, against closed forms and published drag."""

import jax.numpy as jnp
import numpy as np

from microcosmos import fluid, spec
from microcosmos.build.surroundings import build_surroundings

from .cylinder import SANGANI, series
from .flows import after, velocity
from .paths import JAX, Path
from .rows import Result, at_most


def post_drag(radius: float, cell: int, path: Path = JAX) -> float:
    """Measure drag over viscosity and mean velocity of solid posts, one to a box.

    A uniform force drives the flow as a pressure gradient does: it acts on the post too.
    """
    force, viscosity, steps = 1e-6, 0.5, 6000
    post = spec.Post(x=0, y=cell / 2, radius=radius)
    box = spec.World(width=cell, height=cell, viscosity=viscosity, obstacles=(post,))
    solid = build_surroundings(box).solid
    assert solid is not None
    around = fluid.Surroundings(jnp.asarray([force, 0.0], jnp.float32), solid)
    still = tuple(jnp.zeros((cell, cell), jnp.float32) for _ in range(9))
    f = after(still, steps, viscosity, fluid.fixed_magic, around, path)
    driven = jnp.where(solid[None], 0.0, jnp.asarray([force, 0.0], jnp.float32)[:, None, None])
    mean = np.mean(np.asarray(velocity(f, driven)[0], float))
    return float(force * cell**2 / (viscosity * mean))


def check_posts(radii: tuple[float, ...] = (3, 5, 8), path: Path = JAX) -> Result:
    """The surface is a staircase, half a cell outside the solid cells' middles."""
    rows, cell = [], 64
    for radius in radii:
        error = post_drag(radius, cell, path) / series(np.pi * radius**2 / cell**2) - 1
        what = f"drag of a post in an array, R = {radius:g}: relative error"
        rows.append(at_most(what, abs(error), 0.05, SANGANI))
    return Result(rows)
