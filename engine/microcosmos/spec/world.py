"""The box of fluid and its fields, in lattice units (dx = dt = 1)."""

from typing import Literal, Self

from pydantic import Field, model_validator

from .base import Part, unit
from .fields import Energy, Steric
from .sources import LATTICE, TRT, after, source


class World(Part):
    """A periodic box of fluid."""

    model_config = after(LATTICE)

    width: int = Field(default=64, ge=16, le=2048, json_schema_extra=unit("cells"))
    """Size of the box along x."""
    height: int = Field(default=64, ge=16, le=2048, json_schema_extra=unit("cells"))
    """Size of the box along y."""
    viscosity: float = Field(
        default=0.05, ge=1e-3, le=2.0, json_schema_extra=unit("cells²/step")
    )
    """Kinematic viscosity ν; the relaxation time is τ = 3 ν + 1/2."""
    magic: Literal["capped", "fixed"] = Field(default="capped", json_schema_extra=source(TRT))
    """Magic parameter Λ of the two relaxation times: 3/16, or at most (τ − 1/2)/2."""
    fluid: bool = True
    """Whether there is a fluid; without it bodies are moved by their constraints alone."""
    steric: Steric | None = None
    """Repulsion between nodes; empty: filaments pass through each other."""
    energy: Energy | None = None
    """Packets of energy to sense and collect; empty: none."""

    @model_validator(mode="after")
    def refuse_unstable(self) -> Self:
        if self.magic == "fixed" and self.viscosity < 0.01:
            raise ValueError(
                "`magic` must be 'capped' where `viscosity` is below 0.01: with a fixed magic "
                f"parameter the fluid is unstable there; got 'fixed' at {self.viscosity:g}"
            )
        return self
