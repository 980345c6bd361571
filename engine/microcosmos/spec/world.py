"""The fluid, the body and how they are coupled, in lattice units (dx = dt = 1)."""

from typing import Literal, Self

from pydantic import Field, model_validator

from .base import Part, unit

SUPPORT = 4.0
"""Cells that the four-point delta reaches across, beyond a body's own extent."""


class World(Part):
    """A periodic box of fluid."""

    width: int = Field(default=64, ge=16, le=2048, json_schema_extra=unit("cells"))
    """Size of the box along x."""
    height: int = Field(default=64, ge=16, le=2048, json_schema_extra=unit("cells"))
    """Size of the box along y."""
    viscosity: float = Field(
        default=0.05, ge=1e-3, le=2.0, json_schema_extra=unit("cells²/step")
    )
    """Kinematic viscosity ν; the relaxation time is τ = 3 ν + 1/2."""
    magic: Literal["capped", "fixed"] = "capped"
    """Magic parameter Λ of the two relaxation times: 3/16, or at most (τ − 1/2)/2."""

    @model_validator(mode="after")
    def refuse_unstable(self) -> Self:
        if self.magic == "fixed" and self.viscosity < 0.01:
            raise ValueError(
                "`magic` must be 'capped' where `viscosity` is below 0.01: with a fixed magic "
                f"parameter the fluid is unstable there; got 'fixed' at {self.viscosity:g}"
            )
        return self


class Body(Part):
    """A straight chain of nodes along x in the middle of the world."""

    builder: Literal["chain"] = "chain"
    nodes: int = Field(default=32, ge=3, le=4096)
    """Nodes of the filament."""
    spacing: float = Field(default=1.0, ge=0.5, le=2.0, json_schema_extra=unit("cells"))
    """Rest length of an edge; wider than 2 cells, fluid leaks between the nodes."""
    stretch: float = Field(default=1.0, ge=0.0, le=1.0)
    """Share of the stretching error that one projection removes."""
    shear: float = Field(default=1.0, ge=0.0, le=1.0)
    """Share of the shearing error that one projection removes."""
    bend: float = Field(default=1.0, ge=0.0, le=1.0)
    """Share of the bending error that one projection removes."""

    @property
    def length(self) -> float:
        return (self.nodes - 1) * self.spacing


class Coupling(Part):
    """How body and fluid act on each other."""

    projection: Literal["none", "force", "force+torque"] = "force+torque"
    """What the forcing is freed of, so that a body cannot push itself without fluid."""
    force_factor: Literal[1, 2] = 2
    """Force per unit of velocity error; 2 meets the target at the half step."""
    theta_feedback: Literal[0, 1] = 1
    """1: edge angles follow the geometry each step; 0: the paper's literal form."""
    forcing_iterations: int = Field(default=3, ge=1, le=20)
    """Iterations of multi-direct forcing."""
    constraint_iterations: int = Field(default=10, ge=1, le=200)
    """Sweeps of the constraint projection in a step."""
    limits: bool = True
    """Whether displacement and force per step are limited, as random controllers need."""
    max_displacement: float | None = Field(
        default=None, gt=0.0, le=0.5, json_schema_extra=unit("cells/step")
    )
    """Limit of a node's displacement; empty: 0.1, or 0.05 below a viscosity of 0.003."""
    max_force: float | None = Field(
        default=None, gt=0.0, le=0.5, json_schema_extra=unit("cells/step")
    )
    """Limit of a node's forcing; empty: 0.1, or 0.03 below a viscosity of 0.003."""

    @model_validator(mode="after")
    def refuse_unsound(self) -> Self:
        if self.projection == "force+torque" and self.theta_feedback == 0:
            raise ValueError(
                "`projection` must be 'none' or 'force' where `theta_feedback` is 0: edge "
                "angles that ignore the geometry exert a torque of their own; "
                "got 'force+torque'"
            )
        return self

    def displacement_limit(self, viscosity: float) -> float | None:
        """Cells a step, or None where limits are off."""
        if not self.limits:
            return None
        return self.max_displacement or (0.1 if viscosity >= 0.003 else 0.05)

    def force_limit(self, viscosity: float) -> float | None:
        """Cells a step, or None where limits are off."""
        if not self.limits:
            return None
        return self.max_force or (0.1 if viscosity >= 0.003 else 0.03)
