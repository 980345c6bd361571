"""Checks, audits and measurements of one creature."""

from .derivatives import gradient, report_gradient
from .inputs import evaluation_inputs
from .physics import audit
from .reproducibility import Check, check, measurement
