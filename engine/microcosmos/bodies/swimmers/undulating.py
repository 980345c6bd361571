"""Worm and tadpole: "a similar sinusoidal wave propagation along a soft filament", "with
the tadpole reaching lower speeds because of the drag caused by its head" (Microcosmos
paper, hand-designed locomotion).
"""

import numpy as np

from ... import bodies
from .swimmer import Swimmer, column, still
from .tufted import tufted


def worm(
    nodes: int = 32,
    spacing: float = 1.0,
    amplitude: float = 0.15,
    waves: float = 1.0,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Swimmer:
    """A filament along which a wave of bending runs from its first node to its last.

    The joint at share s of the way, 0 for the first, bends by `amplitude`
    sin 2π (`waves` s − t) radians. It swims against the wave, its first node ahead.
    """
    body = bodies.chain(nodes, spacing, stretch=stretch, shear=shear, bend=bend)
    share = np.linspace(0, 1, len(body.joints))

    def gait(time):
        return _wave(time, share, amplitude, waves), still(time, body.edges)

    return Swimmer("worm", body, gait)


def tadpole(
    head_nodes: int = 14,
    tail_nodes: int = 24,
    spacing: float = 1.0,
    amplitude: float = 0.18,
    waves: float = 1.0,
    *,
    stretch: float = 1.0,
    shear: float = 1.0,
    bend: float = 1.0,
) -> Swimmer:
    """A ring with a tail along which a wave of bending runs from the ring to its end.

    Joints between edges of the tail bend like a worm's; the head and the joints that hold
    the tail keep their shape. It swims head first.
    """
    body = tufted(
        head_nodes, np.array([0]), tail_nodes, spacing, stretch=stretch, shear=shear, bend=bend
    )
    bends = np.all(body.joints >= head_nodes, 1)
    share = (np.cumsum(bends) - 1) / max(bends.sum() - 1, 1)

    def gait(time):
        wave = _wave(time, share, amplitude, waves)
        return bends[None] * wave, still(time, body.edges)

    return Swimmer("tadpole", body, gait)


def _wave(time, share: np.ndarray, amplitude: float, waves: float) -> np.ndarray:
    return amplitude * np.sin(2 * np.pi * (waves * share[None] - column(time)))
