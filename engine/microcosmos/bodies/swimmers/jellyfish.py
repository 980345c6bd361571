"""Jellyfish: "contractile movement via uniform distance and bending constraints on an open
circle" (Microcosmos paper).
"""

import numpy as np

from ... import bodies
from .swimmer import Swimmer, column


def jellyfish(
    nodes: int = 32,
    spacing: float = 1.0,
    gap: float = 0.25,
    bending: float = 0.25,
    stretching: float = 0.08,
    phase: float = 0.25,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Swimmer:
    """An open circle, all of which bends and stretches alike.

    Every angle deviates by the share `bending` sin 2π t of itself, every length by the
    share `stretching` sin 2π (t + `phase`): at a quarter of a period the motion is not
    reciprocal. Its opening is at +x, and where inertia counts it swims away from it.
    """
    body = bodies.arc(nodes, spacing, gap, stretch=stretch, shear=shear, bend=bend)

    def gait(time):
        close = bending * np.sin(2 * np.pi * column(time))
        lengthen = stretching * np.sin(2 * np.pi * (column(time) + phase))
        return close * body.rest_angle[None], lengthen * np.ones((1, len(body.edges)))

    return Swimmer("jellyfish", body, gait)
