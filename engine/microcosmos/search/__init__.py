"""Search: evaluation by blocks, variation, and insertion into an archive."""

from .blocks import Stopped, evaluate_blocks, never
from .evaluation import (
    FEATURES,
    STATUSES,
    Evaluation,
    Task,
    block_program,
    centre,
    evaluate,
    measure,
)
from .insertion import Axis, Elites, cells_of, digest, insert, named, no_elites
from .variation import NO_PARENT, OPERATORS, Children, Genes, newcomers, vary

__all__ = [
    "FEATURES",
    "NO_PARENT",
    "OPERATORS",
    "STATUSES",
    "Axis",
    "Children",
    "Elites",
    "Evaluation",
    "Genes",
    "Stopped",
    "Task",
    "block_program",
    "cells_of",
    "centre",
    "digest",
    "evaluate",
    "evaluate_blocks",
    "insert",
    "measure",
    "named",
    "never",
    "newcomers",
    "no_elites",
    "vary",
]
