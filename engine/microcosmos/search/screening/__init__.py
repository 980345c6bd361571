"""Screening: offspring are predicted, and only the promising are simulated."""

from .choice import Predicted, best, expected_gain, heights
from .description import Described, describe
from .model import READY, Model, Regression, learned, with_errors
from .outputs import Outputs
from .resistive import Swim, swim
from .stroke import PHASES, Stroke, Strokes
