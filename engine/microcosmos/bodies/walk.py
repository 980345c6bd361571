"""A filament along a random walk."""

import numpy as np

from .chain import chain
from .graph import Body


def walk(
    nodes: int,
    spacing: float,
    deviation: float,
    seed: int,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Body:
    """`nodes` nodes `spacing` cells apart; each joint turns by an angle drawn from a normal
    distribution of so many rad. The filament may cross itself.
    """
    straight = chain(nodes, spacing, stretch=stretch, shear=shear, bend=bend)
    if not (np.isfinite(deviation) and deviation >= 0):
        raise ValueError(f"`deviation` must be finite and at least 0, got {deviation}.")
    turns = deviation * np.random.default_rng(seed).standard_normal(nodes - 2)
    angle = np.concatenate([[0.0], np.cumsum(turns)])
    steps = spacing * np.stack([np.cos(angle), np.sin(angle)], 1)
    return Body(
        positions=np.concatenate([np.zeros((1, 2)), np.cumsum(steps, 0)]),
        edges=straight.edges,
        joints=straight.joints,
        rest_length=straight.rest_length,
        rest_angle=turns,
        stretch=straight.stretch,
        shear=straight.shear,
        bend=straight.bend,
        arc=straight.arc,
        crossing=True,
    )
