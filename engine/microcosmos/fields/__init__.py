"""Scalar fields on the grid: steric repulsion, energy, and the density of nodes."""

from .density import saturated, splat, unsaturated
from .energy import Energy, Packets, collect, diffuse, packets, placements
from .steric import WEIGHTS, Steric, binomial, capped, gaussian
