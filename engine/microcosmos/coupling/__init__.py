"""The immersed boundary: how bodies and the fluid act on each other."""

from .delta import (
    HAT,
    PESKIN,
    ROMA,
    Kernel,
    Windows,
    divided,
    hat,
    interpolate,
    only,
    peskin,
    roma,
    spread,
    windows,
)
from .forcing import Forced, force_free, multi_direct_forcing, torque_free, unprojected
from .layers import at_nodes, at_points, points

__all__ = [
    "HAT",
    "PESKIN",
    "ROMA",
    "Forced",
    "Kernel",
    "Windows",
    "at_nodes",
    "at_points",
    "divided",
    "force_free",
    "hat",
    "interpolate",
    "multi_direct_forcing",
    "only",
    "peskin",
    "points",
    "roma",
    "spread",
    "torque_free",
    "unprojected",
    "windows",
]
