"""NEAT: how networks arise and vary, and how their genes are numbered."""

from ..genomes import minimal
from .crossover import crossover
from .distance import Coefficients, distance
from .mutation import Novelty, mutate
from .numbering import Counters, first_counters, number
from .rates import Rates

__all__ = [
    "Coefficients",
    "Counters",
    "Novelty",
    "Rates",
    "crossover",
    "distance",
    "first_counters",
    "minimal",
    "mutate",
    "number",
]
