"""NEAT: variation of networks, numbering of their genes, and populations with species."""

from ..genomes import minimal
from .alignment import Coefficients
from .generation import breed, first_species, next_generation
from .graphs import crossover, distance, mutate
from .mutation import Novelty, no_novelty
from .numbering import Counters, compacted, first_counters, number
from .plans import PlanRates
from .settings import PRESETS, Rates, Settings
from .species import Species, divide, no_species
