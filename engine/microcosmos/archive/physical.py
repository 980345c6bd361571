"""Physical units: what a creature is once its length and the period of its stroke are known.

The simulation knows cells and steps alone. A real length of the body and a real period fix
both, and with them the fluid: the viscosity of the lattice is then that of some liquid. The
numbers without a unit (Reynolds, Strouhal, sperm, Mach) stay as they are.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import units
from ..spec import Fold, Scene
from . import export, file, poses
from .quantities import Real, like, shown, square

STROKES = "sine-cosine"
"""The timer of a controller that repeats a stroke."""


@dataclass(frozen=True)
class Physical:
    """Scales of a creature or of an archive, in SI units."""

    length: float
    """Of the body, in m."""
    cells: float
    """Of the body: its reach, the longest way along its edges."""
    period: float
    """Of a stroke, in s."""
    steps: float
    """Of a stroke."""
    viscosity: float
    """Kinematic, of the lattice, in cells²/step."""

    @property
    def scales(self) -> units.Scales:
        return units.Scales.of_stroke(self.length, self.cells, self.period, self.steps)

    @property
    def fluid(self) -> float:
        """Return the kinematic viscosity of the fluid, in m²/s."""
        return self.scales.viscosity(self.viscosity)

    def swimming(self, lengths: Any) -> Any:
        """Convert a speed in body lengths in 1,000 steps, the measure `speed`, to m/s."""
        return lengths / 1000 * self.length * self.steps / self.period

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
    scaled = [scaled_by(scene, one.length, real) for one in streams]
    measured = [name for name in MEASURED if name in table]
    rows = [
        columns(one, {name: table[name][i] for name in measured})
        for i, one in enumerate(scaled)
    ]
    # An archive without elites has the same columns, of a body that nobody has.
    names = columns(scaled_by(scene, 1.0, real), dict.fromkeys(measured, 0.0))
    found = {name: np.array([row[name] for row in rows], float) for name in names}
    return scaled, {"cell": table["index"], "creature": np.array(table["creature"])} | found


MEASURED = ("speed", "reynolds", "strouhal", "mach")


def columns(found: Physical, measures: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the scales make of measures: SI units, and the numbers without a unit."""
    values: dict[str, Any] = {"viscosity_m2_per_s": found.fluid}
    if "speed" in measures:
        values["speed_m_per_s"] = found.swimming(measures["speed"])
    if "reynolds" in measures:
        values["node_speed_m_per_s"] = found.node_speed(measures["reynolds"])
    return values | {name: measures[name] for name in MEASURED[1:] if name in measures}


def scaled_by(scene: Scene, cells: float, real: Real) -> Physical:
    """Return the scales of a body of so many cells.

    Raise `ValueError` for a scene without a fluid or a stroke.
    """
    if not scene.world.fluid:
        raise ValueError("`world.fluid` must be true for physical units, got false")
    steps = stroke_of(scene)
    return Physical(real.length, cells, real.period, steps, scene.world.viscosity)


def stroke_of(scene: Scene) -> float:
    """Return the steps of a stroke; raise `ValueError` for a controller without one."""
    control = scene.control
    timer = "fold" if isinstance(control, Fold) else getattr(control, "timer", STROKES)
    if isinstance(control, Fold) or timer != STROKES:
        raise ValueError(f"`control.timer` must repeat a stroke, got {timer!r}")
    return float(control.period)


def scene_of(spec: Mapping[str, Any]) -> Scene:
    """Return the scene of a run's spec."""
    return Scene.model_validate(
        {name: spec[name] for name in Scene.model_fields if name in spec}
    )
