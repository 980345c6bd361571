"""Scalar fields on the grid: steric repulsion and energy."""

from .energy import Energy, Packets, collect, diffuse, packets
from .steric import Steric, binomial, capped, gaussian

__all__ = [
    "Energy",
    "Packets",
    "Steric",
    "binomial",
    "capped",
    "collect",
    "diffuse",
    "gaussian",
    "packets",
]
