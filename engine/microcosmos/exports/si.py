"""SI units beside the lattice's: columns of a run, given a real length and stroke."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..archive.physical import Physical, scaled_by, scene_of
from ..archive.poses import streams
from ..archive.quantities import Real
from ..bodies import extent
from ..spec import Grown, GrownBody, Scene, is_unavailable, shape
from ..spec.measures import WORK
from .run_file import RunFile, fitness_of
from .table import Column, Columns, Elites, Ragged

SUFFIX = "_si"
OVER_FLUID = ", over density and depth of the fluid"
"""Masses are of the lattice's fluid in a plane: kg become m² by density and depth."""


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
    """What the SI unit leaves to be multiplied, for the title."""


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
    WORK: Unit("m^3/s^2", cells=4, steps=-2, lengths=-1, about=OVER_FLUID),
}
"""Units of measures that have a dimension; a plug-in's counts where it is one of them."""


@dataclass(frozen=True)
class Scaled:
    """The scales of a table's rows."""

    real: Real
    step: float
    """Seconds."""
    cell: np.ndarray | None
    """Metres, for each row or for all; None where rows differ and their bodies are unknown."""

    def factor(self, unit: Unit) -> np.ndarray | None:
        """Return SI units in one unit, for each row or for all; None where it is unknown."""
        if unit.cells and self.cell is None:
            return None
        cell = np.asarray(1.0) if self.cell is None else self.cell
        known = self.step**unit.steps * self.real.length**unit.lengths
        return unit.factor * known * self.real.period**unit.strokes * cell**unit.cells

    def viscosity(self, scene: Scene) -> float | None:
        """Return the kinematic viscosity of a scene's fluid; None where bodies differ."""
        if self.cell is None:
            return None
        return scene.world.viscosity * float(self.cell) ** 2 / self.step


def of_rows(run: RunFile, real: Real) -> list[Physical]:
    """Return the scales of each elite; raise `ValueError` without an archive, fluid, stroke."""
    scene, found = scene_of(run.spec), streams(run.tree, run.attributes)
    return [scaled_by(scene, one.length, real) for one in found]


def of_scene(scene: Scene, real: Real) -> Scaled:
    """Return the scales that all creatures of a scene share, also those that are gone.

    A cell has none where bodies grow, and where a plug-in that is not loaded builds them.
    Raises `ValueError` without a fluid or a stroke.
    """
    grows = isinstance(scene.body, GrownBody) or isinstance(scene.control, Grown)
    unknown = grows or is_unavailable(scene.body)
    found = scaled_by(scene, 1.0 if unknown else extent(shape(scene.body)), real)
    cell = None if unknown else np.asarray(found.scales.cell)
    return Scaled(real, found.scales.step, cell)


def with_si(columns: Columns, run: RunFile, table: str, real: Real) -> Columns:
    """Return the columns of a table, and those in SI units behind them.

    `NAME_si` has the values of `NAME`, in double precision. Tables of elites use the length of
    each body; `curves` and `lineage` have no columns in which cells count where bodies grow.
    """
    run.archive()
    if table in ("archive", "poses"):
        return columns | _of_elites(columns, run, table, real)
    shared = of_scene(scene_of(run.spec), real)
    return columns | _converted(columns, shared, _fitness(run))


def elites_with_si(found: Elites, run: RunFile, real: Real) -> Elites:
    """Return elites with columns in SI units, and the real quantities as attributes."""
    columns = with_si(found.columns, run, "archive", real)
    about = {f"real_{name}": value for name, value in facts(real).items()}
    return Elites(
        found.kind,
        found.axes,
        found.cell,
        columns,
        found.centroids,
        {**found.attributes, **about},
    )


def facts(real: Real) -> dict[str, float]:
    """Return the given quantities, for metadata."""
    return {"length_m": real.length, "period_s": real.period}


def _of_elites(columns: Columns, run: RunFile, table: str, real: Real) -> Columns:
    rows = of_rows(run, real)
    cell = np.array([one.scales.cell for one in rows], float)
    step = rows[0].scales.step if rows else 1.0
    found = _converted(columns, Scaled(real, step, cell), _fitness(run))
    if table == "poses":
        return found
    fluid = np.array([one.fluid for one in rows], float)
    found["cell_size_si"] = Column(cell, "Width of a lattice cell", "m")
    found["viscosity_si"] = Column(fluid, "Kinematic viscosity of the fluid", "m^2/s")
    if "reynolds" in columns:
        speeds = np.asarray(columns["reynolds"].values, float) * fluid / real.length
        found["node_speed_si"] = Column(speeds, "Mean speed of the nodes", "m/s")
    return found


def _converted(columns: Columns, scaled: Scaled, fitness: str) -> Columns:
    found: Columns = {}
    for name, column in columns.items():
        unit = UNITS.get(fitness if column.unit == "fitness" else column.unit)
        factor = None if unit is None else scaled.factor(unit)
        if unit is not None and factor is not None:
            values = _times(column.values, factor)
            found[f"{name}{SUFFIX}"] = Column(values, column.title + unit.about, unit.si)
    return found


def _times(values: Any, factor: np.ndarray) -> Any:
    """Return values times a factor for each row, also in lists of lists."""
    if isinstance(values, Ragged):
        each = np.broadcast_to(factor, len(values.counts))
        return Ragged(_times(values.items, np.repeat(each, values.counts)), values.counts)
    return np.asarray(values, float) * factor


def _fitness(run: RunFile) -> str:
    return fitness_of(run.spec["task"], run.plugins)
