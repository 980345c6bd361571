"""A viscous fluid: D2Q9 lattice Boltzmann with two relaxation times."""

from .dynamics import Rates, capped_magic, collide, fixed_magic, rates, stream, vorticity
from .flows import Developed, developed, poiseuille, shear, vortices
from .lattice import DIRECTIONS, Populations, Vectors, density, equilibrium, fastest, momentum
from .surroundings import Sponge, Surroundings, advance, moving
