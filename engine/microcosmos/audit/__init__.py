"""Checks, audits and measurements of one creature."""

from .derivatives import gradient, gradient_health
from .physics import audit
from .reproducibility import Check, check, measurement
