"""Grown bodies without their empty rows, for drawings and files."""

import numpy as np

from ..graph import Body
from .plan import Capacity, Plan
from .skeleton import skeleton
from .sprouting import grow


def grown_length(plan: Plan, capacity: Capacity) -> float:
    """Return the longest way along the edges of the body that grows from a plan, in cells."""
    grown = grow(plan, capacity)
    apart = grown.distance[grown.present][:, grown.present]
    return capacity.spacing * float(apart.max())


def grown_body(plan: Plan, capacity: Capacity, softest: float = 1.0) -> Body:
    """Return the body that grows from a plan of NumPy arrays, in cells about its first node.

    `softest` is the stiffness of a joint whose gene is 0.
    """
    grown = grow(plan, capacity)
    bones = skeleton(grown, capacity)
    node, edge = np.cumsum(grown.present) - 1, np.cumsum(bones.there) - 1
    away = np.where(grown.present, grown.distance[0], 0)
    ones = np.ones(int(bones.there.sum()))
    stiff = bones.stiffness[bones.bends].astype(float)
    return Body(
        positions=grown.positions[grown.present].astype(float),
        edges=node[bones.edges[bones.there]],
        joints=edge[bones.joints[bones.bends]],
        rest_length=capacity.spacing * ones,
        rest_angle=bones.rest_angle[bones.bends].astype(float),
        stretch=ones,
        shear=ones,
        bend=softest ** (1 - stiff),
        arc=(away / max(away.max(), 1))[grown.present].astype(float),
    )
