"""NEAT: variation of networks, numbering of their genes, and populations with species."""

from ..genomes import minimal
from .crossover import crossover
from .distance import Coefficients, distance
from .generation import breed, first_species, next_generation
from .mutation import Novelty, mutate, no_novelty
from .numbering import Counters, first_counters, number
from .rates import Rates
from .settings import PRESETS, Settings
from .species import Species, divide, no_species
