"""Scalar fields of a world: steric repulsion and energy."""

from typing import Literal, Self

from pydantic import Field, model_validator

from .base import Part, unit
from .sources import OURS, PAPER, after, source


class Steric(Part):
    """Nodes repel each other through their smoothed density."""

    model_config = after(PAPER)

    strength: float = Field(default=4.0, gt=0.0, le=20.0, json_schema_extra=unit("cells³"))
    """Displacement in a step per unit of the density's gradient."""
    limit: float = Field(default=0.1, gt=0.0, le=0.5, json_schema_extra=unit("cells/step"))
    """Limit of a node's displacement by repulsion."""
    smoothing: Literal["gaussian", "binomial"] = "gaussian"
    """A Gaussian by Fourier transform, as in the paper, or a stencil as wide without one."""


class Energy(Part):
    """Gaussian packets at random places, which creatures can sense and collect."""

    model_config = after(PAPER)

    packets: int = Field(default=8, ge=1, le=4096)
    """How many packets there are."""
    width: float = Field(default=4.0, ge=1.0, le=64.0, json_schema_extra=unit("cells"))
    """Standard deviation of a packet."""
    amplitude: float = Field(
        default=1.0, gt=0.0, le=1e3, json_schema_extra=unit("energy/cell²")
    )
    """Energy density in the middle of a packet."""
    seed: int = Field(default=0, ge=0, lt=2**32)
    """Decides where the packets are; the same for every creature."""
    placements: int = Field(default=1, ge=1, le=64)
    """In so many worlds a creature lives, the packets moved to another place in each; what is
    measured are means. With one, a gait that knows the way does as well as one that senses."""
    consume: bool = Field(default=False, json_schema_extra=source(OURS))
    """Whether what is collected is gone; if not, the field is persistent as in the paper."""
    rate: float = Field(default=0.1, gt=0.0, le=1.0)
    """Share of the energy around it that a node takes in a step, where it is consumed."""
    diffusion: float = Field(
        default=0.0, ge=0.0, le=0.25, json_schema_extra=unit("cells²/step")
    )
    """How fast energy spreads; 0: it stays where it is."""

    @model_validator(mode="after")
    def refuse_faint(self) -> Self:
        if self.consume and self.rate * self.amplitude < 1e-6:
            raise ValueError(
                f"`rate` times `amplitude` must be at least 1e-6 for float32 to keep what is "
                f"collected; got {self.rate * self.amplitude:g}"
            )
        return self
