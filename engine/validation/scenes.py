"""Scenes of the checks: bodies in the middle of a fluid at rest, and their rest shapes."""

from typing import Any

import jax
import numpy as np

from microcosmos import bodies, coupling, fields, filaments, groups, world
from microcosmos.bodies import swimmers
from microcosmos.build import build_matching, build_rods
from microcosmos.device import array

from .paths import JAX, Path, roll

LITERAL = world.Form(
    projection=coupling.unprojected,
    theta_feedback=0.0,
    forcing_iterations=1,
    kernel=coupling.PESKIN,
)
"""The paper's literal form: a body can push itself and ignore the flow."""


def parallel_chains(nodes: int, gap: float) -> bodies.Body:
    """Return two straight chains, one above the other."""
    one = bodies.chain(nodes, 1.0)
    return bodies.combined([bodies.placed(one, (0.0, y)) for y in (-gap / 2, gap / 2)])


def steric(strength: float, dtype: Any, gradient: Any = fields.gaussian) -> fields.Steric:
    return fields.Steric(array(strength, dtype), array(0.1, dtype), gradient)


def immersed(
    body: bodies.Body,
    viscosity: float,
    dtype: Any,
    *,
    size: tuple[int, int] = (64, 64),
    **options: Any,
) -> tuple[world.World, world.State]:
    """Return a world of `size` cells with a body at rest in its middle, and its first state."""
    form = options.setdefault("form", world.Form())
    layout = build_matching(body, form.theta_feedback, options.get("nu_c"), dtype)
    box = world.World(
        viscosity=array(viscosity, dtype),
        layout=layout,
        rods=build_rods(body, dtype),
        groups=groups.Groups(array(body.member), body.count),
        size=size,
        **options,
    )
    positions = body.positions - body.positions.mean(0) + np.array(size) / 2
    return box, jax.jit(world.at_rest)(box, array(positions, dtype))


def limits(viscosity: float, dtype: Any) -> world.Limits:
    """Return limits under which random controllers stay finite."""
    # Measured with random controllers over 3,000 steps; see `bodies.check_stability`.
    displacement, force = (0.1, 0.1) if viscosity >= 0.003 else (0.05, 0.03)
    return world.Limits(array(displacement, dtype), array(force, dtype))


def rest(
    body: bodies.Body, turn: np.ndarray, dtype: Any, change: np.ndarray | float = 0.0
) -> filaments.Rest:
    """Return rest shapes: `turn` is added to angles, lengths grow by the share `change`."""
    length = body.rest_length[None] * (1 + change * np.ones((len(turn), len(body.edges))))
    angle = body.rest_angle[None] + turn
    return filaments.Rest(array(angle, dtype), array(length, dtype))


def held(body: bodies.Body, steps: int, dtype: Any) -> filaments.Rest:
    """Return rest shapes of a body that keeps its shape."""
    return rest(body, np.zeros((steps, len(body.joints))), dtype)


def stroke(swimmer: swimmers.Swimmer, period: int, periods: int, dtype: Any) -> filaments.Rest:
    """Return a swimmer's gait, which grows over the first period."""
    time = np.arange(period * periods) / period
    angle, length = swimmer.gait(time)
    rise = np.minimum(time, 1)[:, None]
    return rest(swimmer.body, rise * angle, dtype, rise * length)


def erratic(body: bodies.Body, steps: int, dtype: Any, seed: int) -> filaments.Rest:
    """Return large random angles and lengths, which change every 20 steps."""
    random = np.random.default_rng(seed)
    draws = -(-steps // 20)
    turn = random.uniform(-1, 1, (draws, len(body.joints)))
    change = random.uniform(-0.3, 0.3, (draws, len(body.edges)))
    turn, change = (np.repeat(one, 20, 0)[:steps] for one in (turn, change))
    return rest(body, turn, dtype, change)


def force(measures: world.Measures):
    return measures.force


def places(measures: world.Measures):
    return measures.positions, measures.boxes


def unwrapped(box: world.World, positions: Any, boxes: Any) -> np.ndarray:
    """Return positions from the corner of the first box, in float64."""
    cells = np.asarray(boxes, float) * box.size
    return np.asarray(positions, float) + cells[..., np.asarray(box.groups.member), :]


def moved(box: world.World, start: world.State, end: world.State) -> np.ndarray:
    """Return the displacement of each node between two states, in float64."""
    here, there = (unwrapped(box, one.positions, one.boxes) for one in (start, end))
    return there - here


def recorded(
    box: world.World, start: world.State, shapes: filaments.Rest, path: Path = JAX
) -> np.ndarray:
    """Return positions at the start and after every step, in float64."""
    later = unwrapped(box, *roll(path, box, start, shapes, places)[1])
    return np.concatenate([unwrapped(box, start.positions, start.boxes)[None], later])


def displacement(positions: np.ndarray) -> np.ndarray:
    """Return the displacement of the mean position, from the first to the last."""
    return positions[-1].mean(0) - positions[0].mean(0)
