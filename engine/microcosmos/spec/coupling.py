"""The coupling of bodies and fluid: the paper's form, ours, and combinations."""

from typing import Literal, Self

from pydantic import ConfigDict, model_validator

from .base import DELTAS, FORCING, GUO, LAYERS, OURS, PBD, RODS, Part, field, refuse


class Coupling(Part):
    """Coupling of bodies and fluid."""

    model_config = ConfigDict(json_schema_extra={"seldom": True})

    projection: Literal["none", "force", "force+torque"] = field("force+torque", source=OURS)
    """Net force and torque removed from the forcing, so that no body pushes itself."""
    force_factor: Literal[1, 2] = field(2, source=GUO)
    """Force per unit of velocity error; 2 meets the target at the half step."""
    theta_feedback: Literal[0, 1] = field(1, source=RODS)
    """1: edge angles follow the geometry each step; 0: the paper's literal form."""
    # With Roma's delta three lose at most 2 % of the displacement by 20 iterations; with ten a
    # step takes 1.3 times as long (docs/physics.md, "Forcing").
    forcing_iterations: int = field(3, ge=1, le=20, source=FORCING)
    """Iterations of multi-direct forcing per step."""
    # A worm swims 2.016 cells a stroke with 10 sweeps and 1.985 with 100, a jellyfish 0.336 and
    # 0.153 (docs/physics.md, "Constraints"); stiff bodies need none.
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
    # On half the grid spacing elites go 0.992 times as far with Roma's delta and 0.966 times
    # with Peskin's, and their ranks agree better (docs/physics.md, "The delta").
    kernel: Literal["roma", "peskin", "hat"] = field("roma", source=DELTAS)
    """Delta function between nodes and cells: three (Roma), four (Peskin) or two points wide.
    A narrower one thickens filaments less."""

    @property
    def force_free(self) -> bool:
        """Return whether bodies cannot push themselves; if not, swimming may be an artefact."""
        return self.projection != "none"

    @model_validator(mode="after")
    def refuse_unsound(self) -> Self:
        refuse(
            self.projection == "force+torque" and self.theta_feedback == 0,
            "projection",
            "must be 'none' or 'force' where `theta_feedback` is 0, since "
            "edge angles that ignore the geometry exert a torque; got 'force+torque'",
        )
        for name in ("max_displacement", "max_force"):
            limit = getattr(self, name)
            refuse(
                not self.limits and limit is not None,
                name,
                f"must be empty where `limits` is false; got {limit}",
            )
        return self

    def displacement_limit(self, viscosity: float) -> float | None:
        """Return the cells per step, or None where limits are off."""
        if not self.limits:
            return None
        # At viscosity 0.001 random controllers blew up with 0.1 in 7 of 7 trials, with 0.05 in
        # none of 4.
        return self.max_displacement or (0.1 if viscosity >= 0.003 else 0.05)

    def force_limit(self, viscosity: float) -> float | None:
        """Return the cells per step, or None where limits are off."""
        if not self.limits:
            return None
        return self.max_force or (0.1 if viscosity >= 0.003 else 0.03)


def refuse_without_feasible(coupling: Coupling, name: str) -> None:
    """Raise `ValueError` if no body is force-free, as the field `name` demands."""
    refuse(
        not coupling.force_free,
        name,
        "must be false where `coupling.projection` is 'none', since every body "
        "then pushes itself; got true",
    )
