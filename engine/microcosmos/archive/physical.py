"""Physical units: what a creature is once its length and the period of its stroke are known.

The simulation knows cells and steps alone. A real length of the body and a real period fix
both, and with them the fluid: the viscosity of the lattice is then that of some liquid. The
numbers without a unit (Reynolds, Strouhal, sperm, Mach) stay as they are.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, log10
from typing import Any

import numpy as np

from .. import units
from ..bodies import extent
from ..spec import GrownBody, Scene, shape
from . import creature, export, file, poses
from .export import Source

FLUIDS = {
    "acetone": 0.39e-6,
    "water": 1.00e-6,
    "ethanol": 1.5e-6,
    "air": 15.1e-6,
    "olive oil": 92e-6,
    "glycerol": 1120e-6,
    "honey": 7000e-6,
}
"""Kinematic viscosities at 20 °C, in m²/s: viscosity over density. Of liquids but oil and honey
and of air: CRC Handbook of Chemistry and Physics. Olive oil 84 mPa s and 0.913 g/cm³, honey
about 10 Pa s and 1.42 g/cm³: typical values, which vary by a factor of two."""

LIKE = 1.5
"""Largest ratio of two viscosities that are called alike."""

PREFIXES = {"km": 1e3, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6}
PREFIXES |= {"nm": 1e-9}
TIMES = {"min": 60.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6}
NUMBER = re.compile(r"\s*([0-9.]+(?:e[+-]?[0-9]+)?)\s*([^\W\d]+)\s*")
SHOWN = ((1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


def length(text: str) -> float:
    """Return a length such as `1mm` in metres. Raise `ValueError` for any other text."""
    return _quantity("length", text, PREFIXES, "1mm or 50um")


def period(text: str) -> float:
    """Return a time such as `0.5s` in seconds. Raise `ValueError` for any other text."""
    return _quantity("period", text, TIMES, "0.5s or 20ms")


def _quantity(field: str, text: str, known: Mapping[str, float], such: str) -> float:
    found = NUMBER.fullmatch(text)
    if found and found[2] in known:
        try:
            value = float(found[1]) * known[found[2]]
        except ValueError:
            value = 0.0
        if value > 0 and isfinite(value):
            return value
    raise ValueError(
        f"`{field}` must be a number above 0 with a unit, such as {such}; got {text!r}"
    )


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


def physical(source: Mapping[str, Any] | Source, length: str, period: str) -> dict[str, Any]:
    """Return physical units of a creature file, or columns of those of an archive file.

    `length` is the real length of the body, such as `1mm`, `period` that of a stroke, such as
    `0.5s`. Speeds are in m/s and viscosities in m²/s. Raise `ValueError` as `of_creature` and
    `of_archive` do.
    """
    if isinstance(source, Mapping):
        return dict(of_creature(source, length, period)[1])
    data = export.source_bytes(source)
    if data.startswith(file.HDF5):
        return dict(of_archive(data, length, period)[1])
    return dict(of_creature(data, length, period)[1])


def of_creature(
    document: Mapping[str, Any] | bytes, length: str, period: str
) -> tuple[Physical, dict[str, float]]:
    """Return the scales of a creature file, and its numbers: SI units and none.

    Raise `ValueError` for a creature without a fluid or a stroke, and for a body that grew from
    its genome, whose length only an archive file holds.
    """
    parsed = creature.parse(document)
    scene = creature.scene_of(parsed)
    if isinstance(scene.body, GrownBody):
        raise ValueError(
            "`body` must be given in the file, got one that grows: give the archive"
        )
    found = _scaled(scene, float(extent(shape(scene.body))), length, period)
    measures = (parsed["measured"] or {}).get("measures", {})
    numbers = {name: float(value) for name, value in columns(found, measures).items()}
    return found, numbers | {"sperm": sperm(scene)}


def of_archive(
    data: bytes, length: str, period: str
) -> tuple[list[Physical], dict[str, np.ndarray]]:
    """Return the scales of each elite of an archive file, and columns of their numbers.

    Each elite has the given length. Raise `ValueError` for a run without an archive, a fluid or
    a stroke.
    """
    tree, attributes = file.load(data)
    table = export.columns(data)
    streams = poses.streams(tree, attributes)
    scene = Scene.model_validate(_scene(json.loads(attributes["spec"])))
    scaled = [_scaled(scene, one.length, length, period) for one in streams]
    rows = [
        columns(one, {name: table[name][i] for name in MEASURED if name in table})
        for i, one in enumerate(scaled)
    ]
    names = list(rows[0]) if rows else []
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


def sperm(scene: Scene) -> float:
    """Return the effective sperm number of a body of given shape; see `units.sperm`."""
    body, coupling = shape(scene.body), scene.coupling
    joints = max(1, round(float(extent(body)) / float(body.rest_length.max())) - 1)
    bend = float(body.bend.min())
    if coupling.nu_c is not None:
        bend = bend / (1 + scene.world.viscosity / coupling.nu_c)
    slowest = units.relaxation(joints, bend, coupling.constraint_iterations)
    return units.sperm(_steps(scene), slowest)


def _scaled(scene: Scene, cells: float, of_body: str, of_stroke: str) -> Physical:
    if not scene.world.fluid:
        raise ValueError("`world.fluid` must be true for physical units, got false")
    given = length(of_body), cells, period(of_stroke), _steps(scene)
    return Physical(*given, scene.world.viscosity)


def _steps(scene: Scene) -> float:
    control: Any = scene.control
    if getattr(control, "timer", "sine-cosine") != "sine-cosine":
        raise ValueError(f"`control.timer` must repeat a stroke, got {control.timer!r}")
    return float(control.period)


def _scene(spec: Mapping[str, Any]) -> dict[str, Any]:
    return {name: spec[name] for name in Scene.model_fields if name in spec}


def like(viscosity: float) -> str:
    """Say which fluid has a kinematic viscosity in m²/s, or between which two it lies."""
    names = sorted(FLUIDS, key=FLUIDS.__getitem__)
    nearest = min(names, key=lambda name: abs(log10(FLUIDS[name] / viscosity)))
    ratio = viscosity / FLUIDS[nearest]
    if 1 / LIKE <= ratio <= LIKE:
        return f"as {nearest}"
    above = [name for name in names if FLUIDS[name] > viscosity]
    if not above:
        return f"{ratio:,.3g} times that of {names[-1]}"
    if len(above) == len(names):
        return f"less than common liquids: that of {names[0]} is {1 / ratio:,.3g} times as high"
    return f"between {names[names.index(above[0]) - 1]} and {above[0]}"


def shown(value: float, unit: str) -> str:
    """Format a quantity with a prefix, such as `0.27 mm/s`."""
    size = abs(value)
    scale, prefix = next(((s, p) for s, p in SHOWN if size >= 0.9995 * s), SHOWN[-1])
    return f"{value / scale:.3g} {prefix}{unit}" if value else f"0 {unit}"


def square(viscosity: float) -> str:
    """Format a kinematic viscosity in m²/s as mm²/s."""
    return f"{viscosity * 1e6:.3g} mm²/s"
