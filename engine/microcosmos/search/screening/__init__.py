"""Screening: offspring are predicted, and only the promising are simulated."""

from .choice import Outputs, Predicted, best, expected_gain, heights
from .description import Described, describe
from .model import READY, Model, Regression, learned, with_errors
from .stroke import PHASES, Stroke, Strokes, Swim, swim
