"""The immersed boundary: how a body and the fluid act on each other."""

from .delta import Windows, peskin, read, spread, windows
from .forcing import Forced, force_free, multi_direct_forcing, torque_free, unprojected

__all__ = [
    "Forced",
    "Windows",
    "force_free",
    "multi_direct_forcing",
    "peskin",
    "read",
    "spread",
    "torque_free",
    "unprojected",
    "windows",
]
