"""Emitters: sources of children."""

from .bandit import Bandit
from .cma_mae import CmaMae
from .cma_mega import CmaMega
from .elites import Random, newcomers
from .emitter import (
    NO_PARENT,
    OPERATORS,
    Children,
    Emitter,
    Learner,
    Outcome,
    begin,
    emit,
    emit_chosen,
    outcome,
    tell,
    with_slots,
)
from .lamarckian import Lamarckian
from .neat import Neat
from .population import PopulationNeat
from .selection import credit
from .vectors import IsoLine
