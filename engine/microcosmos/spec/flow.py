"""Flows that bodies swim in."""

from typing import Literal

from .base import Part, field, sourced
from .sources import OURS


class Flow(Part):
    """A steady flow that a body force keeps up; the fluid starts in it."""

    model_config = sourced(OURS)

    kind: Literal["poiseuille", "shear", "vortices"] = "poiseuille"
    """Poiseuille flow along x between walls at y = 0; shear, a sine wave u = speed ·
    sin(2π y / height) along x, whose shear is strongest in the middle; or an array of vortices
    that turn against each other, one of which has its centre in the middle."""
    speed: float = field(0.01, gt=0.0, le=0.05, unit="cells/step")
    """Largest speed of the flow: in the middle of the channel, at the crests of the wave, or at
    the rims of the vortices."""
    vortices: int = field(2, ge=2, le=64, multiple_of=2)
    """Vortices along each side of the box."""
