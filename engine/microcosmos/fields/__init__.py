"""Fields on the grid: repulsion, obstacles, energy, and the density of nodes."""

from .energy import Energy, Packets, collect, diffuse, packets, placements
from .steric import (
    WEIGHTS,
    Barrier,
    Steric,
    away,
    binomial,
    capped,
    gaussian,
    saturated,
    splat,
    unsaturated,
)
