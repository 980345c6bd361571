"""The immersed boundary: how bodies and the fluid act on each other."""

from .delta import (
    HAT,
    PESKIN,
    ROMA,
    Kernel,
    Windows,
    divided,
    interpolate,
    masked,
    peskin,
    roma,
    spread,
    windows,
)
from .forcing import (
    Forced,
    force_free,
    multi_direct_forcing,
    step_lengths,
    torque_free,
    unprojected,
)
from .layers import at_nodes, at_points, points
