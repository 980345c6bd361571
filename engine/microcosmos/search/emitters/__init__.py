"""Emitters: where children come from."""

from . import population
from .cma_mae import CmaMae
from .cma_mega import CmaMega
from .elites import newcomers
from .emitter import NO_PARENT, OPERATORS, Children, Divided, Emitter, Outcome, emit, tell
from .lamarckian import Lamarckian
from .learner import Learner, Slopes
from .neat import Neat
from .random import Random
from .vectors import IsoLine

__all__ = [
    "NO_PARENT",
    "OPERATORS",
    "Children",
    "CmaMae",
    "CmaMega",
    "Divided",
    "Emitter",
    "IsoLine",
    "Lamarckian",
    "Learner",
    "Neat",
    "Outcome",
    "Random",
    "Slopes",
    "emit",
    "newcomers",
    "population",
    "tell",
]
