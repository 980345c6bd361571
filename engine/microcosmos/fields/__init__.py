"""Fields on the grid: repulsion, obstacles, energy, and the density of nodes."""

from .barrier import Barrier, away
from .density import saturated, splat, unsaturated
from .energy import Energy, Packets, collect, diffuse, packets, placements
from .steric import WEIGHTS, Steric, binomial, capped, gaussian
