"""A viscous fluid: D2Q9 lattice Boltzmann with two relaxation times."""

from .dynamics import Rates as Rates
from .dynamics import capped_magic as capped_magic
from .dynamics import collide as collide
from .dynamics import fixed_magic as fixed_magic
from .dynamics import rates as rates
from .dynamics import stream as stream
from .dynamics import vorticity as vorticity
from .lattice import Populations as Populations
from .lattice import Vectors as Vectors
from .lattice import density as density
from .lattice import equilibrium as equilibrium
from .lattice import momentum as momentum
from .surroundings import Sponge as Sponge
from .surroundings import Surroundings as Surroundings
from .surroundings import advance as advance
