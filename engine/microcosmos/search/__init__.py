"""Search: evaluation by blocks, variation, and insertion into an archive."""

from . import cvt, emitters, folding, gradients, reevaluation
from .blocks import Stopped, evaluate_blocks, never
from .cells import Axis, Cells, Grid, Voronoi, voronoi
from .emitters import NO_PARENT, OPERATORS, Children, Emitter, Outcome, Slopes
from .evaluation import (
    STATUSES,
    Actuator,
    Evaluation,
    Goal,
    Task,
    block_program,
    drive,
    elsewhere,
    evaluate,
    mapped,
    measured,
    motion_of,
    simulate,
)
from .health import Health, gradient_health
from .insertion import Elites, Inserted, clipped, digest, insert, insert_program, no_elites
from .measures import MEASURES, Observations, motion, observe
from .plugin_measures import Measure, Motion
from .slopes import slopes, slopes_program
from .strokes import STROKE_MEASURES, Conditions, Watched, impulse, stroke_program, swim, watch

__all__ = [
    "MEASURES",
    "NO_PARENT",
    "OPERATORS",
    "STATUSES",
    "STROKE_MEASURES",
    "Actuator",
    "Axis",
    "Cells",
    "Children",
    "Conditions",
    "Elites",
    "Emitter",
    "Evaluation",
    "Goal",
    "Grid",
    "Health",
    "Inserted",
    "Measure",
    "Motion",
    "Observations",
    "Outcome",
    "Slopes",
    "Stopped",
    "Task",
    "Voronoi",
    "Watched",
    "block_program",
    "clipped",
    "cvt",
    "digest",
    "drive",
    "elsewhere",
    "emitters",
    "evaluate",
    "evaluate_blocks",
    "folding",
    "gradient_health",
    "gradients",
    "impulse",
    "insert",
    "insert_program",
    "mapped",
    "measured",
    "motion",
    "motion_of",
    "never",
    "no_elites",
    "observe",
    "reevaluation",
    "simulate",
    "slopes",
    "slopes_program",
    "stroke_program",
    "swim",
    "voronoi",
    "watch",
]
