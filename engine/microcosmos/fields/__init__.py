"""Fields on the grid: repulsion, obstacles, energy, and the density of nodes."""

from . import contact, food
from .contact import Contact, Density, density, touching
from .energy import Energy, Packets, collect, diffuse, packets, placements
from .food import Food, changed, eaten
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
