"""SI units beside the lattice's: columns of a run, given a real length and stroke."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..archive import measured
from ..archive.poses import streams
from ..bodies import extent
from ..quantities.real import Real
from ..quantities.scales import Physical, own_strokes, scaled_by, scene_of
from ..spec import GrownBody, Scene, is_unavailable, shape
from ..units import UNITS, Unit
from .run_file import RunFile, fitness_of
from .tables import Column, Columns, Elites, Ragged

SUFFIX = "_si"


@dataclass(frozen=True)
class Scaled:
    """The scales of a table's rows."""

    real: Real
    step: np.ndarray
    """Seconds, for each row or for all."""
    cell: np.ndarray | None
    """Metres, for each row or for all; None where rows differ and their bodies are unknown."""

    def factor(self, unit: Unit) -> np.ndarray | None:
        """Return SI units in one unit, for each row or for all; None where it is unknown."""
        if unit.cells and self.cell is None:
            return None
        cell = np.asarray(1.0) if self.cell is None else self.cell
        real = self.real
        return unit.in_si(cell=cell, step=self.step, length=real.length, stroke=real.period)

    def viscosity(self, scene: Scene) -> float | None:
        """Return the kinematic viscosity of a scene's fluid; None where bodies differ."""
        if self.cell is None:
            return None
        return scene.world.viscosity * float(self.cell) ** 2 / float(self.step)


def of_rows(run: RunFile, real: Real) -> list[Physical]:
    """Return the scales of each elite; raise `ValueError` without an archive, fluid, stroke."""
    scene, found = scene_of(run.spec), streams(run.tree, run.attributes)
    measures = measured.columns(run.tree, run.attributes)
    steps = own_strokes(scene, measures, len(found))
    return [
        scaled_by(scene, one.length, real, own) for one, own in zip(found, steps, strict=True)
    ]


def of_scene(scene: Scene, real: Real) -> Scaled:
    """Return the scales that all creatures of a scene share, also those that are gone.

    A stroke takes the controller's period: how long those took that are gone is unknown.
    `cell` is None where creatures inherit the size of their body, or where a plug-in that is
    not loaded builds it.
    Raises `ValueError` without a fluid or a stroke.
    """
    own = isinstance(scene.body, GrownBody) or getattr(scene.control, "rest_length", None)
    unknown = own or is_unavailable(scene.body)
    physical = scaled_by(scene, 1.0 if unknown else extent(shape(scene.body)), real)
    cell = None if unknown else np.asarray(physical.scales.cell)
    return Scaled(real, np.asarray(physical.scales.step), cell)


def with_si(columns: Columns, run: RunFile, table: str, real: Real) -> Columns:
    """Return the columns of a table, and those in SI units behind them.

    `NAME_si` has the values of `NAME`, in double precision. Tables of elites use the length of
    each body; `curves` and `lineage` have no columns in which cells count where bodies differ.
    """
    run.archive()
    if table in ("archive", "poses"):
        return columns | _of_elites(columns, run, table, real)
    shared = of_scene(scene_of(run.spec), real)
    return columns | _converted(columns, shared, _fitness(run))


def elites_with_si(elites: Elites, run: RunFile, real: Real) -> Elites:
    """Return elites with columns in SI units, and the real quantities as attributes."""
    columns = with_si(elites.columns, run, "archive", real)
    about = {f"real_{name}": value for name, value in facts(real).items()}
    return Elites(
        elites.kind,
        elites.axes,
        elites.cell,
        columns,
        elites.centroids,
        {**elites.attributes, **about},
    )


def facts(real: Real) -> dict[str, float]:
    """Return the given quantities, for metadata."""
    return {"length_m": real.length, "period_s": real.period}


def _of_elites(columns: Columns, run: RunFile, table: str, real: Real) -> Columns:
    rows = of_rows(run, real)
    cell = np.array([one.scales.cell for one in rows], float)
    step = np.array([one.scales.step for one in rows], float)
    converted = _converted(columns, Scaled(real, step, cell), _fitness(run))
    if table == "poses":
        return converted
    fluid = np.array([one.fluid for one in rows], float)
    converted["cell_size_si"] = Column(cell, "Width of a lattice cell", "m")
    converted["viscosity_si"] = Column(fluid, "Kinematic viscosity of the fluid", "m^2/s")
    if "reynolds" in columns:
        speeds = np.asarray(columns["reynolds"].values, float) * fluid / real.length
        converted["node_speed_si"] = Column(speeds, "Mean speed of the nodes", "m/s")
    return converted


def _converted(columns: Columns, scaled: Scaled, fitness: str) -> Columns:
    converted: Columns = {}
    for name, column in columns.items():
        unit = UNITS.get(fitness if column.unit == "fitness" else column.unit)
        factor = None if unit is None else scaled.factor(unit)
        if unit is not None and factor is not None:
            values = _times(column.values, factor)
            converted[f"{name}{SUFFIX}"] = Column(values, column.title + unit.about, unit.si)
    return converted


def _times(values: Any, factor: np.ndarray) -> Any:
    """Return values times a factor for each row, also in lists of lists."""
    if isinstance(values, Ragged):
        each = np.broadcast_to(factor, len(values.counts))
        return Ragged(_times(values.items, np.repeat(each, values.counts)), values.counts)
    # In double precision, since metres of a cell are far from 1.
    return np.asarray(values, float) * factor


def _fitness(run: RunFile) -> str:
    return fitness_of(run.spec["task"], run.plugins)
