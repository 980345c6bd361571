"""Emitters: where children come from."""

from . import population
from .cma_mae import CmaMae
from .elites import newcomers
from .emitter import NO_PARENT, OPERATORS, Children, Emitter, Outcome, emit, tell
from .neat import Neat
from .random import Random
from .vectors import IsoLine

__all__ = [
    "NO_PARENT",
    "OPERATORS",
    "Children",
    "CmaMae",
    "Emitter",
    "IsoLine",
    "Neat",
    "Outcome",
    "Random",
    "emit",
    "newcomers",
    "population",
    "tell",
]
