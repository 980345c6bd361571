"""Measures, poses and status of a motion, by the native kernel."""

from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ..archive.poses import FRAMES, MOMENTS
from ..naming import FORMS
from ..world import Measures, State, World, grown_nodes, native
from .measures import MEASURES
from .window import Poses, Window

ELSEWHERE = ("hidden_nodes", "connections", "trial_spread", *FORMS, "crossing")
"""Measures of the genome, of several trials, of the form and of the poses."""
SUMMARISED = tuple(name for name in MEASURES if name not in ELSEWHERE)
"""Measures in the order of the kernel's."""
SHOWN = 7
"""Numbers beside the measures: middle and scale of the poses, the window, the status."""

Scalar = Float[Array, ""]


def summarise(
    world: World,
    start: State,
    end: State,
    observed: Measures,
    clock: Float[Array, "time"],
    period: float | None,
    length: Scalar | float,
    instruction_set: str | None = None,
) -> tuple[dict[str, Scalar], Poses, Int[Array, ""]]:
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
    places, frames, shown, measures = native.call(target, shapes, operands, sizes)
    begun, stop, strokes, status = shown[3:].astype(jnp.int32)
    found = Poses(
        positions=frames.astype(jnp.int16),
        path=places,
        origin=shown[:2],
        scale=shown[2],
        window=Window(begun, stop, strokes),
        length=jnp.asarray(length, jnp.float32),
        present=grown_nodes(world),
        edges=jnp.asarray(world.rods.edges, jnp.int32),
    )
    return dict(zip(SUMMARISED, measures, strict=True)), found, status


def _results(nodes: int) -> Sequence[tuple[int, ...]]:
    return [(MOMENTS, 2), (FRAMES, nodes, 2), (SHOWN,), (len(SUMMARISED),)]


def _operands(
    world: World, start: State, end: State, observed: Measures
) -> tuple[list[Any], dict[str, int]]:
    rods, (height, width) = world.rods, world.size
    collected = end.collected
    graph = (rods.edges, rods.joints, grown_nodes(world))
    operands = [
        *end.populations,
        start.positions,
        start.angles,
        *(jnp.asarray(one, jnp.int32) for one in graph),
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
    }
    return operands, sizes
