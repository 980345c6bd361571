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
    at_nodes,
    at_points,
    force_free,
    multi_direct_forcing,
    points,
    step_lengths,
    torque_free,
    unprojected,
)
