"""Route of physical units: convert typed quantities to the scales of a cell and a step."""

from collections.abc import Callable
from typing import Annotated

from fastapi import APIRouter, Query

from microcosmos.quantities.real import length_of, like, period_of
from microcosmos.quantities.scales import Physical

from ..auth.authorize import PUBLIC
from ..core.schemas import Wire

router = APIRouter(prefix="/units", tags=["creatures"])

Typed = Annotated[str | None, Query(max_length=50)]
Number = Annotated[float | None, Query(ge=1e-6, le=1e9)]


class Scales(Wire):
    """SI units of a body in its world."""

    cell: float
    """m"""
    step: float
    """s"""
    viscosity: float
    """Kinematic, in m²/s."""
    fluid: str
    """A fluid of that viscosity, or those between which it lies."""
    speed: float
    """m/s of one body length in 1,000 steps, the unit of the measure `speed`."""
    node_speed: float
    """m/s of the nodes at a Reynolds number of 1."""


class Units(Wire):
    """Quantities in SI units; what is missing or cannot be read is null."""

    length: float | None
    period: float | None
    wrong: list[str]
    """Fields that hold no quantity. This is no error: somebody may still be typing."""
    scales: Scales | None
    """Null without both quantities and the three numbers of a body."""


@router.get("", dependencies=[PUBLIC])
def read_units(
    length: Typed = None,
    period: Typed = None,
    cells: Number = None,
    steps: Number = None,
    viscosity: Number = None,
) -> Units:
    """Read a real length, such as `1 mm`, and the period of a stroke, such as `0.5 s`.

    With the `cells` of a body, the `steps` of its stroke and the `viscosity` of its fluid in
    cells²/step, return the scales in SI units too.
    """
    wrong: list[str] = []

    def read(field: str, typed: str | None, of: Callable[[str], float]) -> float | None:
        try:
            return of(typed) if typed else None
        except ValueError:
            wrong.append(field)
            return None

    found = Units(
        length=read("length", length, length_of),
        period=read("period", period, period_of),
        wrong=wrong,
        scales=None,
    )
    if found.length and found.period and cells and steps and viscosity:
        body = Physical(found.length, cells, found.period, steps, viscosity)
        found.scales = Scales(
            cell=body.scales.cell,
            step=body.scales.step,
            viscosity=body.fluid,
            fluid=like(body.fluid),
            speed=body.swimming(1.0),
            node_speed=body.node_speed(1.0),
        )
    return found
