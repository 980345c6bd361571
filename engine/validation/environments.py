"""Checks of boxes that specs describe: obstacles and flows, against theory and experiment."""

from typing import Literal

import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, fluid, spec, world
from microcosmos.build import build_flow, build_start, build_surroundings, build_world

from . import scenes
from .cylinder import SANGANI, series
from .flows import EXACT, after, distance, velocity
from .paths import JAX, Path, roll
from .rows import Result, at_most, close


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
    # The force acts in every cell of the box, and in the steady state the post takes all of it.
    return float(force * cell**2 / (viscosity * mean))


def check_posts(radii: tuple[float, ...] = (3, 5, 8), path: Path = JAX) -> Result:
    """Check the drag of posts, whose surface is a staircase half a cell outside solid cells."""
    rows, cell = [], 64
    for radius in radii:
        error = post_drag(radius, cell, path) / series(np.pi * radius**2 / cell**2) - 1
        what = f"drag of a post in an array, R = {radius:g}: relative error"
        rows.append(at_most(what, abs(error), 0.05, SANGANI))
    return Result(rows)


Kind = Literal["poiseuille", "shear", "vortices"]
SIDE = 64


def in_flow(
    kind: Kind, body: bodies.Body, place: tuple[float, float], viscosity: float, speed: float
) -> tuple[world.World, world.State]:
    """Return a body at a place in a flow of a spec, and its first state."""
    flow = spec.Flow(kind=kind, speed=speed)
    box = spec.World(width=SIDE, height=SIDE, viscosity=viscosity, flow=flow)
    built = build_world(box, spec.Coupling(), body)
    arms = body.positions - body.positions.mean(0)
    return built, build_start(box, built, arms + np.array(place))


def flow_error(kind: Kind, viscosity: float, steps: int, path: Path = JAX) -> float:
    """Return the relative L2 distance of a spec's fluid from its closed form after `steps`."""
    flow = spec.Flow(kind=kind, speed=0.01)
    box = spec.World(width=SIDE, height=SIDE, viscosity=viscosity, flow=flow)
    exact, around = build_flow(box), build_surroundings(box)
    assert exact is not None
    pair = bodies.chain(2, 1.0)
    start = build_start(box, build_world(box, spec.Coupling(), pair), pair.positions)
    f = after(start.populations, steps, viscosity, around=around, path=path)
    force = exact.force if exact.force.ndim == 3 else exact.force[:, None, None]
    u = velocity(f, jnp.broadcast_to(jnp.asarray(force, jnp.float32), (2, SIDE, SIDE)))
    fluids = np.ones((SIDE, SIDE), bool) if box.solid is None else ~box.solid
    return distance(np.asarray(u)[:, fluids], exact.velocity[:, fluids])


def check_flows(steps: int = 10_000, path: Path = JAX) -> Result:
    """Check that flows stay as they start. Λ is capped, as for creatures."""
    rows = []
    for kind in ("poiseuille", "shear", "vortices"):
        for viscosity in (0.01, 0.05, 0.5):
            error = flow_error(kind, viscosity, steps, path)
            what = f"{kind}, ν {viscosity:g}, after {steps:,} steps: relative L2"
            rows.append(at_most(what, error, 2e-3, EXACT))
    return Result(rows)


def check_carried(steps: int = 4000, path: Path = JAX) -> Result:
    """Check that a ring turns with half the shear, and that two nodes move with the flow."""
    ring = bodies.ring(16, 1.0)
    box, start = in_flow("shear", ring, (SIDE / 2, SIDE / 2), 0.1, 0.02)
    end, _ = roll(path, box, start, scenes.held(ring, steps, "float32"))
    rate = -0.5 * 0.02 * 2 * np.pi / SIDE * np.cos(np.pi)
    turned = float(np.mean(np.asarray(end.angles - start.angles))) / (rate * steps)
    rows = [close("ring in shear: turn over half the shear", turned, 1.0, 0.04, EXACT)]
    pair, height = bodies.chain(2, 1.0), 16.0
    box, start = in_flow("poiseuille", pair, (SIDE / 2, height), 0.1, 0.02)
    end, _ = roll(path, box, start, scenes.held(pair, steps, "float32"))
    moved = scenes.moved(box, start, end).mean(0)
    across, y = SIDE - 1, height - 0.5
    local = 4 * 0.02 * y * (across - y) / across**2
    what = "tracer in Poiseuille flow: speed over that of the flow"
    rows.append(close(what, float(moved[0]) / (local * steps), 1.0, 0.01, EXACT))
    return Result(rows)
