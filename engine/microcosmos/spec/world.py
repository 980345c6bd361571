"""The box of fluid and its scalar fields, in lattice units (dx = dt = 1)."""

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from .base import Part, field, sourced
from .copies import Copies
from .flow import Flow
from .obstacles import Obstacle, solid_cells
from .sources import LATTICE, OURS, PAPER, TRT


class Steric(Part):
    """Repulsion between nodes by the gradient of their smoothed density."""

    model_config = sourced(PAPER)

    strength: float = field(4.0, gt=0.0, le=20.0, unit="cells³")
    """Displacement per step and unit of the density's gradient."""
    limit: float = field(0.1, gt=0.0, le=0.5, unit="cells/step")
    """Limit of a node's displacement by repulsion."""
    smoothing: Literal["gaussian", "binomial"] = "gaussian"
    """Gaussian by Fourier transform (the paper), or a binomial stencil of the same width."""


class Energy(Part):
    """Gaussian packets of energy at random places, to be sensed and collected."""

    model_config = sourced(PAPER)

    packets: int = field(8, ge=1, le=4096)
    """Number of packets."""
    width: float = field(4.0, ge=1.0, le=64.0, unit="cells")
    """Standard deviation of a packet."""
    amplitude: float = field(1.0, gt=0.0, le=1e3, unit="energy/cell²")
    """Energy density in the middle of a packet."""
    seed: int = field(0, ge=0, lt=2**32)
    """Random seed of the packets' places, which are the same for every creature."""
    placements: int = field(1, ge=1, le=64)
    """Worlds per creature, each with the packets moved; measures are means over them. With
    several, a memorised path does not help; only sensing does."""
    consume: bool = field(False, source=OURS)
    """Remove collected energy; otherwise the field is persistent, as in the paper."""
    rate: float = field(0.1, gt=0.0, le=1.0)
    """Share of the energy around a node that it takes per step, if energy is consumed."""
    diffusion: float = field(0.0, ge=0.0, le=0.25, unit="cells²/step")
    """Diffusion coefficient of the energy; 0: none."""

    @model_validator(mode="after")
    def refuse_faint(self) -> Self:
        if self.consume and self.rate * self.amplitude < 1e-6:
            raise ValueError(
                "`rate` times `amplitude` must be 1e-6 or more, or float32 loses what is "
                f"collected; got {self.rate * self.amplitude}"
            )
        return self


MAX_SOLID = 0.75
"""Largest share of the box that obstacles may fill."""


class World(Part):
    """A periodic box of fluid."""

    model_config = sourced(LATTICE)

    width: int = field(48, ge=16, le=2048, unit="cells")
    """Width of the box (x)."""
    height: int = field(48, ge=16, le=2048, unit="cells")
    """Height of the box (y)."""
    viscosity: float = field(0.05, ge=1e-3, le=2.0, unit="cells²/step")
    """Kinematic viscosity ν; the relaxation time is τ = 3 ν + 1/2."""
    magic: Literal["capped", "fixed"] = field("capped", source=TRT)
    """Magic parameter Λ of the two relaxation times: 3/16 (fixed), or at most (τ − 1/2)/2."""
    fluid: bool = True
    """Simulate the fluid; without it, only constraints and repulsion move bodies."""
    steric: Steric | None = None
    """Repulsion between nodes; empty: filaments pass through each other."""
    energy: Energy | None = None
    """Packets of energy; empty: none."""
    obstacles: tuple[Obstacle, ...] = field((), max_length=64, source=OURS)
    """Fixed obstacles, which hold the fluid at rest on their surface and keep bodies out;
    empty: none."""
    flow: Flow | None = None
    """A flow that the creature swims in; empty: the fluid starts at rest."""
    copies: Copies | None = None
    """A school of copies of the creature; empty: it swims alone."""

    @property
    def open(self) -> bool:
        """Whether all places and directions in the box are alike but for energy."""
        return not self.obstacles and self.flow is None

    @property
    def solid(self) -> np.ndarray | None:
        """Return the mask (x, y) of cells without fluid; None: there are none."""
        walled = self.flow is not None and self.flow.kind == "poiseuille"
        if not self.obstacles and not walled:
            return None
        solid = solid_cells(self.obstacles, (self.width, self.height))
        solid[:, 0] |= walled
        return solid

    @model_validator(mode="after")
    def refuse_full(self) -> Self:
        if (solid := self.solid) is not None and (found := solid.mean()) > MAX_SOLID:
            raise ValueError(
                f"`obstacles` must leave at least {1 - MAX_SOLID:.0%} of the box to the fluid, "
                f"got {1 - found:.0%}"
            )
        return self

    @model_validator(mode="after")
    def refuse_dry(self) -> Self:
        if self.flow is not None and not self.fluid:
            raise ValueError("`flow` must be empty where `fluid` is false; got one")
        return self

    @model_validator(mode="after")
    def refuse_unstable(self) -> Self:
        if self.magic == "fixed" and self.viscosity < 0.01:
            raise ValueError(
                "`magic` must be 'capped' where `viscosity` is below 0.01, since a fixed magic "
                f"parameter is unstable there; got 'fixed' at {self.viscosity:g}"
            )
        return self
