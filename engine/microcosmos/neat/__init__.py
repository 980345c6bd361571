"""NEAT: how networks arise and vary, and how their genes are numbered."""

from .mutation import Novelty, Rates, minimal, mutate
from .numbering import Counters, first_counters, number

__all__ = ["Counters", "Novelty", "Rates", "first_counters", "minimal", "mutate", "number"]
