"""Scalar fields on the grid: steric repulsion, energy, and how densely nodes lie."""

from .density import saturated as saturated
from .density import splat as splat
from .density import unsaturated as unsaturated
from .energy import Energy as Energy
from .energy import Packets as Packets
from .energy import collect as collect
from .energy import diffuse as diffuse
from .energy import packets as packets
from .energy import placements as placements
from .steric import Steric as Steric
from .steric import binomial as binomial
from .steric import capped as capped
from .steric import gaussian as gaussian
