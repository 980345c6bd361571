"""Emitters: sources of children."""

from ...operators import OPERATORS
from .emitter import (
    NO_PARENT,
    Children,
    Emitter,
    Keys,
    Learner,
    Outcome,
    Problem,
    Stateless,
    begin,
    children,
    emit,
    emit_chosen,
    newcomers,
    or_newcomers,
    outcome,
    parentless,
    tell,
    with_slots,
)
from .population import Population, PopulationNeat, build_population
from .selection import credit, draw
from .strategies import CmaMae, CmaMega, build_cma_mae, build_cma_mega
from .variation import (
    IsoLine,
    Neat,
    Random,
    Selecting,
    build_gaussian,
    build_line,
    build_neat,
    build_random,
)
