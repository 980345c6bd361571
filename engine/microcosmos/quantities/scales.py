"""Physical units of a creature, by the real length of its body and the period of its stroke.

The simulation knows cells and steps alone. A real length of the body and a real period fix
both, and with them the fluid: the viscosity of the lattice is then that of some liquid. The
numbers without a unit (Reynolds, Strouhal, sperm, Mach) stay as they are.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from math import isclose, nan
from typing import Any

import numpy as np

from .. import units
from ..archive import export, file, poses
from ..invalid import InvalidField
from ..measures import MEASURES
from ..spec import Fold, Scene
from .real import Real, like, shown, square

STROKES = "sine-cosine"
"""The timer of a controller that repeats a stroke."""


@dataclass(frozen=True)
class Physical:
    """Scales of a creature or of an archive, in SI units."""

    length: float
    """Length of the body, in m."""
    cells: float
    """Length of the body in cells: its reach, the longest way along its edges."""
    period: float
    """Period of a stroke, in s."""
    steps: float
    """Steps of a stroke, as `own_stroke` counts them."""
    viscosity: float
    """Kinematic viscosity of the lattice, in cells²/step."""

    @property
    def scales(self) -> units.Scales:
        return units.Scales.of_stroke(self.length, self.cells, self.period, self.steps)

    @property
    def fluid(self) -> float:
        """Return the kinematic viscosity of the fluid, in m²/s."""
        return self.scales.viscosity(self.viscosity)

    def swimming(self, lengths: Any) -> Any:
        """Convert a speed in body lengths in 1,000 steps, the measure `speed`, to m/s."""
        unit, scales = units.UNITS[MEASURES["speed"].unit], self.scales
        known = {"cell": scales.cell, "step": scales.step}
        return lengths * unit.in_si(**known, length=self.length, stroke=self.period)

    def node_speed(self, reynolds: Any) -> Any:
        """Return the mean speed of the nodes in m/s: Re ν / L, from the definition of Re."""
        return reynolds * self.fluid / self.length

    def sentence(self) -> str:
        """Return the assumption and its consequences, for a caption."""
        scales = self.scales
        return (
            f"With a body of {shown(self.length, 'm')} and a stroke of "
            f"{shown(self.period, 's')}, a cell is {shown(scales.cell, 'm')}, a step "
            f"{shown(scales.step, 's')}, the kinematic viscosity {square(self.fluid)} "
            f"({like(self.fluid)}), and a speed of 1 length in 1,000 steps "
            f"{shown(self.swimming(1.0), 'm/s')}."
        )


def of_archive(data: bytes, real: Real) -> tuple[list[Physical], dict[str, np.ndarray]]:
    """Return the scales of each elite of an archive file, and columns of their numbers.

    Each elite has the given length. Raise `ValueError` for a run without an archive, a fluid or
    a stroke.
    """
    tree, attributes = file.load(data)
    table, scene = export.columns(data), scene_of(json.loads(attributes["spec"]))
    streams = poses.streams(tree, attributes)
    strokes = own_strokes(scene, table, len(streams))
    scaled = [
        scaled_by(scene, one.length, real, steps)
        for one, steps in zip(streams, strokes, strict=True)
    ]
    measured = [name for name in MEASURED if name in table]
    rows = [
        columns(one, {name: table[name][i] for name in measured})
        for i, one in enumerate(scaled)
    ]
    # An archive without elites has the same columns, of a body that nobody has.
    names = columns(scaled_by(scene, 1.0, real), dict.fromkeys(measured, 0.0))
    numbers = {name: np.array([row[name] for row in rows], float) for name in names}
    return scaled, {"cell": table["index"], "creature": np.array(table["creature"])} | numbers


MEASURED = ("speed", "reynolds", "strouhal", "mach")


def columns(physical: Physical, measures: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the scales make of measures: SI units, and the numbers without a unit."""
    values: dict[str, Any] = {"viscosity_m2_per_s": physical.fluid}
    if "speed" in measures:
        values["speed_m_per_s"] = physical.swimming(measures["speed"])
    if "reynolds" in measures:
        values["node_speed_m_per_s"] = physical.node_speed(measures["reynolds"])
    return values | {name: measures[name] for name in MEASURED[1:] if name in measures}


def scaled_by(scene: Scene, cells: float, real: Real, steps: float | None = None) -> Physical:
    """Return the scales of a body of so many cells, whose stroke takes so many steps: those of
    the controller's period if none are given.

    Raise `ValueError` for a scene without a fluid or a stroke.
    """
    if not scene.world.fluid:
        raise InvalidField("world.fluid", "must be true for physical units, got false")
    steps = stroke_of(scene) if steps is None else steps
    return Physical(real.length, cells, real.period, steps, scene.world.viscosity)


def own_stroke(scene: Scene, measures: Mapping[str, Any]) -> float:
    """Return the steps in which a creature did a stroke, from its measures.

    A body at its limit of speed slows its clock: its strokes take longer than the controller's
    period. `stride` is the displacement in a stroke, `speed` that in 1,000 steps, both over the
    same strokes. Below two strokes both are 0: it is NaN where a limit may have slowed the
    clock. Without a limit or without the measures it is the period. Raise `ValueError` for a
    controller without a stroke.
    """
    period = stroke_of(scene)
    if not getattr(scene.control, "max_speed", None) or not {"stride", "speed"} <= {*measures}:
        return period
    stride, speed = float(measures["stride"]), float(measures["speed"])
    steps = 1000 * stride / speed if speed > 0 else nan
    # The measures have single precision: a stroke that nothing slowed is the period to 1e-4.
    return period if isclose(steps, period, rel_tol=1e-4) else steps


def own_strokes(scene: Scene, table: Mapping[str, Any], count: int) -> list[float]:
    """Return the steps of a stroke of each row of a table of elites, as `own_stroke`."""
    known = {name: table[name] for name in ("stride", "speed") if name in table}
    rows = ({name: values[row] for name, values in known.items()} for row in range(count))
    return [own_stroke(scene, one) for one in rows]


def stroke_of(scene: Scene) -> float:
    """Return the steps of a stroke of a clock that nothing slows.

    Raise `ValueError` for a controller without a stroke.
    """
    control = scene.control
    timer = "fold" if isinstance(control, Fold) else getattr(control, "timer", STROKES)
    if isinstance(control, Fold) or timer != STROKES:
        raise InvalidField("control.timer", f"must repeat a stroke, got {timer!r}")
    return float(control.period)


def scene_of(spec: Mapping[str, Any]) -> Scene:
    """Return the scene of a run's spec."""
    return Scene.model_validate(
        {name: spec[name] for name in Scene.model_fields if name in spec}
    )
