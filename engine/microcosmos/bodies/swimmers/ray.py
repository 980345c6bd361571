"""Ray: "beating via a single time-dependent angle constraint" (Microcosmos paper)."""

import numpy as np

from ... import bodies
from .swimmer import Swimmer, column, still


def ray(
    nodes: int = 31,
    spacing: float = 1.0,
    offset: float = 0.5,
    amplitude: float = 0.8,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Swimmer:
    """A filament whose middle joint bends by `offset` + `amplitude` sin 2π t radians.

    Its way back is its way there, reversed: without inertia it must not get anywhere
    (Purcell 1977, the scallop theorem).
    """
    body = bodies.chain(nodes, spacing, stretch=stretch, shear=shear, bend=bend)
    middle = np.arange(len(body.joints)) == len(body.joints) // 2

    def gait(time):
        beat = offset + amplitude * np.sin(2 * np.pi * column(time))
        return beat * middle[None], still(time, body.edges)

    return Swimmer("ray", body, gait)
