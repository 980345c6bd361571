"""The coupling of bodies and fluid: the paper's form, ours, and combinations."""

from typing import Literal, Self

from pydantic import ConfigDict, model_validator

from .base import Part, field
from .sources import DELTAS, FORCING, GUO, LAYERS, OURS, PBD, RODS


class Coupling(Part):
    """Coupling of bodies and fluid."""

    model_config = ConfigDict(json_schema_extra={"seldom": True})

    projection: Literal["none", "force", "force+torque"] = field("force+torque", source=OURS)
    """Net force and torque removed from the forcing, so that no body pushes itself."""
    force_factor: Literal[1, 2] = field(2, source=GUO)
    """Force per unit of velocity error; 2 meets the target at the half step."""
    theta_feedback: Literal[0, 1] = field(1, source=RODS)
    """1: edge angles follow the geometry each step; 0: the paper's literal form."""
    forcing_iterations: int = field(3, ge=1, le=20, source=FORCING)
    """Iterations of multi-direct forcing per step."""
    constraint_iterations: int = field(10, ge=1, le=200, source=PBD)
    """Sweeps of the constraint projection per step."""
    limits: bool = True
    """Limit displacement and force per step; random controllers need it."""
    max_displacement: float | None = field(None, gt=0.0, le=0.5, unit="cells/step")
    """Limit of a node's displacement; empty: 0.1, or 0.05 below viscosity 0.003."""
    max_force: float | None = field(None, gt=0.0, le=0.5, unit="cells/step")
    """Limit of a node's forcing; empty: 0.1, or 0.03 below viscosity 0.003."""
    layers: Literal[1, 2] = field(1, source=LAYERS)
    """Marker layers of a filament; 2: half a cell to either side, as in the paper."""
    nu_c: float | None = field(None, gt=0.0, le=1e3, unit="cells²/step", source=OURS)
    """Viscosity at which actuators have half their strength; empty: constant strength."""
    kernel: Literal["roma", "peskin", "hat"] = field("roma", source=DELTAS)
    """Delta function between nodes and cells: three (Roma), four (Peskin) or two points wide.
    A narrower one thickens filaments less."""

    @property
    def force_free(self) -> bool:
        """Return whether bodies cannot push themselves; if not, swimming may be an artefact."""
        return self.projection != "none"

    @model_validator(mode="after")
    def refuse_unsound(self) -> Self:
        if self.projection == "force+torque" and self.theta_feedback == 0:
            raise ValueError(
                "`projection` must be 'none' or 'force' where `theta_feedback` is 0, since "
                "edge angles that ignore the geometry exert a torque; got 'force+torque'"
            )
        return self

    def displacement_limit(self, viscosity: float) -> float | None:
        """Return the cells per step, or None where limits are off."""
        if not self.limits:
            return None
        return self.max_displacement or (0.1 if viscosity >= 0.003 else 0.05)

    def force_limit(self, viscosity: float) -> float | None:
        """Return the cells per step, or None where limits are off."""
        if not self.limits:
            return None
        return self.max_force or (0.1 if viscosity >= 0.003 else 0.03)


def refuse_without_feasible(coupling: Coupling, name: str) -> None:
    """Raise `ValueError` if no body is force-free, as the field `name` demands."""
    if not coupling.force_free:
        raise ValueError(
            f"`{name}` must be false where `coupling.projection` is 'none', since every body "
            "then pushes itself; got true"
        )
