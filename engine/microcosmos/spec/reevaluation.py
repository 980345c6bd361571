"""Repeated evaluation of creatures under disturbed conditions."""

from typing import Self

from pydantic import model_validator

from .base import Part, field, sourced
from .sources import ADAPTIVE, REEVALUATION, STANDARD_ERROR


class Reevaluation(Part):
    """Repeated evaluation under disturbed conditions: a test of the elites and, if it decides,
    the condition to become one."""

    model_config = sourced(REEVALUATION)

    every: int = field(25, ge=1, le=1_000_000, unit="generations")
    """Interval; elites are also evaluated after the last generation."""
    samples: int = field(4, ge=1, le=100, unit="evaluations")
    """Evaluations per elite each time, and the fewest of a mean that decides."""
    decides: bool = field(False, source=ADAPTIVE)
    """Evaluate offspring that would enter the archive again, and let their mean fitness and
    mean descriptors compete; they need not enter the archive then."""
    max_samples: int = field(12, ge=1, le=1000, unit="evaluations")
    """Most evaluations of a mean that decides."""
    max_error: float = field(0.02, ge=0.0, le=1.0, source=STANDARD_ERROR)
    """Standard error above which a mean gets more evaluations: of fitness relative to its
    range in archive and offspring, of a descriptor relative to its axis."""
    phase: bool = True
    """Start a periodic timer at a random phase."""
    pose: bool = True
    """Start the body at a random position and angle."""
    viscosity: float = field(0.05, ge=0.0, le=0.5)
    """Largest relative change of the viscosity."""
    energy: bool = True
    """Move the packets of energy to random places."""

    @model_validator(mode="after")
    def refuse_too_few(self) -> Self:
        if self.max_samples < self.samples:
            raise ValueError(
                f"`max_samples` must be at least `samples` ({self.samples}), got "
                f"{self.max_samples}"
            )
        return self
