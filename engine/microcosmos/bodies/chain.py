"""A straight filament."""

import numpy as np

from .graph import Body


def chain(
    nodes: int,
    spacing: float,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Body:
    """`nodes` nodes along x, `spacing` cells apart, with the same stiffness everywhere."""
    if nodes < 2:
        raise ValueError(f"`nodes` must be at least 2, got {nodes}.")
    number = np.arange(nodes)
    edges = np.stack([number[:-1], number[1:]], 1)
    joints = np.stack([number[:-2], number[1:-1]], 1)
    return Body(
        positions=np.stack([number * spacing, np.zeros(nodes)], 1),
        edges=edges,
        joints=joints,
        rest_length=np.full(len(edges), float(spacing)),
        rest_angle=np.zeros(len(joints)),
        stretch=np.full(len(edges), float(stretch)),
        shear=np.full(len(edges), float(shear)),
        bend=np.full(len(joints), float(bend)),
        arc=number / (nodes - 1),
    )
