"""Conversion between lattice and physical units, and the dimensionless numbers of swimming.

Lattice units are cells and steps, with a density of 1. The length of a creature and the
viscosity of its fluid fix the physical units.
"""

from dataclasses import dataclass
from math import inf, isnan, pi
from typing import Any, NamedTuple

WATER = 1.0e-6
"""Kinematic viscosity of water at 20 °C, m²/s."""

SOUND_SPEED = 3**-0.5
"""Speed of sound of the D2Q9 lattice, in cells per step."""

MAX_MACH = 0.17
"""Mach number up to which errors of compressibility, its square, stay below 3 %."""

MAX_LIMITED = 1e-3
"""Largest share of node steps at a limit without a warning."""

MAX_IMPULSE = 1e-4
"""Largest net impulse of a body on the fluid, in mass · cells/step: round-off gives less."""

MAX_CROSSING = 0.0
"""Largest share of poses in which filaments cross: in a plane they cannot."""

MAX_SPACING = 2.0
"""Node spacing in cells above which fluid leaks between the nodes."""

OVER_FLUID = ", over density and depth of the fluid"
"""Masses are of the lattice's fluid in a plane: kg become m² by density and depth."""


def _power(name: str, power: int) -> str:
    return name if power == 1 else name + "²³⁴"[power - 2]


class Unit(NamedTuple):
    """A unit of the lattice as a product of powers, and the SI unit that it becomes."""

    si: str
    cells: int = 0
    steps: int = 0
    lengths: int = 0
    """Power of the body's length."""
    strokes: int = 0
    factor: float = 1.0
    about: str = ""
    """The factor that the SI unit leaves out, for the title."""

    def in_si(self, *, cell: Any, step: Any, length: Any, stroke: Any) -> Any:
        """Return SI units in one unit, given metres of a cell and of the body, and seconds of a
        step and of a stroke."""
        known = step**self.steps * length**self.lengths
        return self.factor * known * stroke**self.strokes * cell**self.cells

    @property
    def formula(self) -> str:
        """The factor to SI units, in x, t, ℓ and τ."""
        powers = {"x": self.cells, "ℓ": self.lengths, "t": self.steps, "τ": self.strokes}
        above = [_power(one, n) for one, n in powers.items() if n > 0]
        below = [_power(one, -n) for one, n in powers.items() if n < 0]
        below = [f"{1 / self.factor:,.0f}"] * (self.factor != 1) + below
        under = " ".join(below) if len(below) < 2 else f"({' '.join(below)})"
        return (" ".join(above) or "1") + (f" / {under}" if below else "")


UNITS = {
    "cells": Unit("m", cells=1),
    "cells²": Unit("m^2", cells=2),
    "1/cells": Unit("1/m", cells=-1),
    "steps": Unit("s", steps=1),
    "cells/step": Unit("m/s", cells=1, steps=-1),
    "lengths": Unit("m", lengths=1),
    "lengths/1,000 steps": Unit("m/s", lengths=1, steps=-1, factor=1e-3),
    "per stroke": Unit("1/s", strokes=-1),
    "waves per length": Unit("1/m", lengths=-1),
    # A cell of the fluid has the mass 1: cells² times density and depth.
    "mass · cells/step": Unit("m^3/s", cells=3, steps=-1, about=OVER_FLUID),
    "mass · cells²/step³": Unit("m^4/s^3", cells=4, steps=-3, about=OVER_FLUID),
    "mass · cells²/step² per length": Unit(
        "m^3/s^2", cells=4, steps=-2, lengths=-1, about=OVER_FLUID
    ),
}
"""Units of measures that have a dimension; a plug-in's counts where it is one of them."""

DIMENSIONLESS = ("", "rad", "rad²", "share", "energy", "fitness")
"""Units of measures without a dimension, and those of counts whose size a spec chooses."""


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
        if not all(0 < one < inf for one in (length, cells, viscosity, fluid)):
            raise ValueError(
                "`length`, `cells`, `viscosity` and `fluid` must be finite and above 0, got "
                f"{length:g}, {cells:g}, {viscosity:g} and {fluid:g}"
            )
        cell = length / cells
        return cls(cell, viscosity * cell**2 / fluid)

    @classmethod
    def of_stroke(cls, length: float, cells: float, period: float, steps: float) -> "Scales":
        """Scale a body of `cells` cells to `length` metres, a stroke of `steps` to `period` s.

        The lattice's viscosity then stands for a fluid: `viscosity` says which. With NaN for
        `steps`, a stroke of unknown duration, times are NaN.
        """
        known = (length, cells, period) if isnan(steps) else (length, cells, period, steps)
        if not all(0 < one < inf for one in known):
            raise ValueError(
                "`length`, `cells`, `period` and `steps` must be finite and above 0, got "
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
    reasons = []
    if mach > MAX_MACH:
        reasons.append(f"Mach {mach:.2f} is above {MAX_MACH}: the flow is compressible")
    if limited > MAX_LIMITED:
        reasons.append(f"limits acted on {100 * limited:.1f} % of node steps")
    if spacing > MAX_SPACING:
        reasons.append(
            f"nodes are {spacing:.2g} cells apart, above {MAX_SPACING:g}: fluid leaks"
        )
    return reasons
