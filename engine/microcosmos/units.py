"""Conversion between lattice and physical units, and the dimensionless numbers of swimming.

Lattice units are cells and steps, with a density of 1. The length of a creature and the
viscosity of its fluid fix the physical units.
"""

from dataclasses import dataclass
from math import pi
from typing import Any

WATER = 1.0e-6
"""Kinematic viscosity of water at 20 °C, m²/s."""

SOUND_SPEED = 3**-0.5
"""Speed of sound of the D2Q9 lattice, in cells per step."""

MAX_MACH = 0.17
"""Mach number up to which errors of compressibility, its square, stay below 3 %."""

MAX_LIMITED = 1e-3
"""Largest share of node steps at a limit without a warning."""

MAX_IMPULSE = 1e-4
"""Largest net impulse of a body on the fluid, in lattice units: round-off gives less."""

MAX_CROSSING = 0.0
"""Largest share of poses in which filaments cross: in a plane they cannot."""

MAX_SPACING = 2.0
"""Node spacing in cells above which fluid leaks between the nodes."""


@dataclass(frozen=True)
class Scales:
    """The size of a cell in metres and of a step in seconds."""

    cell: float
    step: float

    @classmethod
    def of(
        cls, length: float, cells: float, viscosity: float, fluid: float = WATER
    ) -> "Scales":
        """Scale a body of `cells` cells to `length` metres, in a fluid of `fluid` m²/s.

        The lattice's `viscosity` in cells²/step fixes the step.
        """
        if min(length, cells, viscosity, fluid) <= 0:
            raise ValueError(
                "`length`, `cells`, `viscosity` and `fluid` must be above 0, got "
                f"{length:g}, {cells:g}, {viscosity:g} and {fluid:g}"
            )
        cell = length / cells
        return cls(cell, viscosity * cell**2 / fluid)

    @classmethod
    def of_stroke(cls, length: float, cells: float, period: float, steps: float) -> "Scales":
        """Scale a body of `cells` cells to `length` metres, a stroke of `steps` to `period` s.

        The lattice's viscosity then stands for a fluid: `viscosity` says which.
        """
        if min(length, cells, period, steps) <= 0:
            raise ValueError(
                "`length`, `cells`, `period` and `steps` must be above 0, got "
                f"{length:g}, {cells:g}, {period:g} and {steps:g}"
            )
        return cls(length / cells, period / steps)

    def viscosity(self, lattice: float) -> float:
        """Convert a kinematic viscosity in cells²/step to m²/s."""
        return lattice * self.cell**2 / self.step

    def metres(self, cells: float) -> float:
        return cells * self.cell

    def seconds(self, steps: float) -> float:
        return steps * self.step

    def speed(self, cells_per_step: float) -> float:
        """Convert a speed to metres per second."""
        return cells_per_step * self.cell / self.step


def reynolds(speed: Any, length: Any, viscosity: Any) -> Any:
    """Return the Reynolds number U L / ν, with the mean speed of the nodes as U."""
    return speed * length / viscosity


def mach(speed: Any) -> Any:
    """Return the Mach number."""
    return speed / SOUND_SPEED


def sperm(period: float, relaxation: float) -> float:
    """Return the effective sperm number (ω t)^(1/4), with the relaxation time t of the shape.

    For an elastic filament it is L (ζ ω / B)^(1/4) (Machin, J. Exp. Biol. 35, 796, 1958):
    the fourth root of frequency times relaxation time up to a constant. Bodies here have no
    modulus B; the rate at which a shape follows what is commanded replaces it.
    """
    return (2 * pi * relaxation / period) ** 0.25


def warnings(*, mach: float, limited: float, spacing: float) -> list[str]:
    """Return the reasons why a simulation may have left the method's range of validity."""
    found = []
    if mach > MAX_MACH:
        found.append(f"Mach {mach:.2f} is above {MAX_MACH}: the flow is compressible")
    if limited > MAX_LIMITED:
        found.append(f"limits acted on {100 * limited:.1f} % of node steps")
    if spacing > MAX_SPACING:
        found.append(f"nodes are {spacing:.2g} cells apart, above {MAX_SPACING:g}: fluid leaks")
    return found
