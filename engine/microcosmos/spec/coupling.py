"""How bodies and the fluid act on each other: the paper's form, ours, and what is between."""

from typing import Literal, Self

from pydantic import Field, model_validator

from .base import SELDOM, Part, unit
from .sources import DELTAS, FORCING, GUO, LAYERS, OURS, PBD, RODS, source


class Coupling(Part):
    """How body and fluid act on each other."""

    model_config = SELDOM

    projection: Literal["none", "force", "force+torque"] = Field(
        default="force+torque", json_schema_extra=source(OURS)
    )
    """What the forcing is freed of, so that a body cannot push itself without fluid."""
    force_factor: Literal[1, 2] = Field(default=2, json_schema_extra=source(GUO))
    """Force per unit of velocity error; 2 meets the target at the half step."""
    theta_feedback: Literal[0, 1] = Field(default=1, json_schema_extra=source(RODS))
    """1: edge angles follow the geometry each step; 0: the paper's literal form."""
    forcing_iterations: int = Field(default=3, ge=1, le=20, json_schema_extra=source(FORCING))
    """Iterations of multi-direct forcing."""
    constraint_iterations: int = Field(default=10, ge=1, le=200, json_schema_extra=source(PBD))
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
    layers: Literal[1, 2] = Field(default=1, json_schema_extra=source(LAYERS))
    """2: the filament acts through two layers, half a cell to either side, as in the paper."""
    nu_c: float | None = Field(
        default=None, gt=0.0, le=1e3, json_schema_extra=unit("cells²/step") | source(OURS)
    )
    """Viscosity at which actuators have half of their strength; empty: they never tire."""
    kernel: Literal["peskin", "roma", "hat"] = Field(
        default="peskin", json_schema_extra=source(DELTAS)
    )
    """The delta between nodes and cells: four, three or two points wide."""

    @property
    def force_free(self) -> bool:
        """Whether a body cannot push itself; if not, its swimming may be the solver's."""
        return self.projection != "none"

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
