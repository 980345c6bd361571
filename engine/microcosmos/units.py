"""Between lattice and physical units, and the numbers that decide how a swimmer swims.

Inside, everything is in lattice units: cells, steps, and a density of 1. A creature is
something physical once its length and the viscosity of its fluid are known.
"""

from dataclasses import dataclass
from math import cos, log, pi
from typing import Any

WATER = 1.0e-6
"""Kinematic viscosity of water at 20 °C, m²/s."""

SOUND_SPEED = 3**-0.5
"""Of the D2Q9 lattice, cells a step."""

FASTEST = 0.17
"""Mach number up to which errors of compressibility, of its square, stay below 3 %."""

LIMITED = 1e-3
"""Share of node steps in which a limit may act unnoticed."""

WIDEST = 2.0
"""Node spacing in cells from which fluid leaks between the nodes."""


@dataclass(frozen=True)
class Scales:
    """What a cell and a step are, in metres and seconds."""

    cell: float
    step: float

    @classmethod
    def of(
        cls, length: float, cells: float, viscosity: float, fluid: float = WATER
    ) -> "Scales":
        """A body `length` metres long over `cells` cells, in a fluid of `fluid` m²/s.

        The lattice's `viscosity` in cells² a step fixes the step.
        """
        if min(length, cells, viscosity, fluid) <= 0:
            raise ValueError(
                "`length`, `cells`, `viscosity` and `fluid` must be above 0, got "
                f"{length:g}, {cells:g}, {viscosity:g} and {fluid:g}"
            )
        cell = length / cells
        return cls(cell, viscosity * cell**2 / fluid)

    def metres(self, cells: float) -> float:
        return cells * self.cell

    def seconds(self, steps: float) -> float:
        return steps * self.step

    def speed(self, cells_a_step: float) -> float:
        """Metres a second."""
        return cells_a_step * self.cell / self.step


def reynolds(speed: Any, length: Any, viscosity: Any) -> Any:
    """Inertia against viscosity, U L / ν, with the mean speed of the nodes as U."""
    return speed * length / viscosity


def mach(speed: Any) -> Any:
    """Against the lattice's speed of sound."""
    return speed / SOUND_SPEED


def relaxation(joints: int, bend: float, sweeps: int) -> float:
    """Steps in which the slowest bend of a chain of joints relaxes to 1/e.

    A sweep with stiffness k changes the errors C of a chain of J joints by
    k/2 (C₋ − 2 C + C₊), red joints before black ones, with no error beyond the ends. The
    slowest mode, a half wave over J + 1, is multiplied in a sweep by g where, for a half
    sweep each and c = cos(π/(J + 1)), g = ((s + √(s² + 4 (1 − k))) / 2)² and s = k c
    (successive over-relaxation: Young, Trans. Am. Math. Soc. 76, 92, 1954).
    """
    if joints < 1 or not 0 < bend <= 1:
        raise ValueError(
            f"`joints` must be at least 1 and `bend` above 0, at most 1, got {joints}, {bend:g}"
        )
    s = bend * cos(pi / (joints + 1))
    root = (s + (s * s + 4 * (1 - bend)) ** 0.5) / 2
    if root == 0:
        return 0.0
    return -1 / (2 * sweeps * log(root))


def sperm(period: float, relaxation: float) -> float:
    """Effective sperm number, (ω t)^(1/4) with the time t in which bending relaxes.

    Of an elastic filament it is L (ζ ω / B)^(1/4) (Machin, J. Exp. Biol. 35, 796, 1958):
    the fourth root of frequency times relaxation time up to a constant. Constraint
    projection knows no modulus B; how fast its sweeps relax a bend stands in its place.
    """
    return (2 * pi * relaxation / period) ** 0.25


def warnings(*, mach: float, limited: float, spacing: float) -> list[str]:
    """Why a simulation may have left the range in which the method is sound."""
    found = []
    if mach > FASTEST:
        found.append(f"Mach {mach:.2f} is above {FASTEST}: the flow is compressible")
    if limited > LIMITED:
        found.append(f"limits acted on {100 * limited:.1f} % of node steps")
    if spacing > WIDEST:
        found.append(f"nodes are {spacing:.2g} cells apart, above {WIDEST:g}: fluid leaks")
    return found
