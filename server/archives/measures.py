"""Recorded measures of elites, and the axes of an archive."""

from dataclasses import asdict
from math import prod
from typing import Literal

from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from microcosmos.spec import Archive, PluginVersion, plugins_in
from microcosmos.spec.measures import MEASURES

from ..tables import Creature, Elite, Run
from .schemas import Axis, Measure


def has_archive(run: Run) -> bool:
    """Return whether the result is an archive; otherwise it is a table."""
    return "search" in run.spec


def axes(run: Run) -> list[Axis]:
    described = run.spec["archive"]["descriptors"]
    return [Axis(**{name: axis[name] for name in Axis.model_fields}) for axis in described]


def kind(run: Run) -> tuple[Literal["grid", "cvt", "pool"], int]:
    """Return the kind of the archive's cells, and their number."""
    described = run.spec["archive"]
    if described.get("container") is not None:
        return "pool", Archive.model_validate(described).places
    centroids = described.get("centroids")
    if centroids is not None:
        return "cvt", centroids
    return "grid", prod(axis.bins for axis in axes(run))


def recorded(session: Session, run: Run) -> list[Measure]:
    """Return the measures of the run's elites; before the first elite, those to come."""
    one = select(Creature.measured).join(Elite, Elite.creature == Creature.sha256)
    measured = session.scalars(one.where(Elite.run_id == run.id).limit(1)).first()
    names = measured["measures"] if measured else list(MEASURES)
    descriptors = run.spec["archive"]["descriptors"]
    of_plugins = [axis["name"] for axis in descriptors if axis.get("plugin")]
    versions = {one.name: one.version for one in plugins_in(run.spec)}
    ends = {axis.name: axis for axis in axes(run)}
    return [
        _measure(name, versions.get(name), ends.get(name))
        for name in dict.fromkeys((*names, *of_plugins))
    ]


def _measure(name: str, plugin: PluginVersion | None, axis: Axis | None) -> Measure:
    """Return a measure with its title; one that this version does not know has its name."""
    known = MEASURES.get(name)
    if plugin is None and known is not None:
        return Measure(name=name, **asdict(known))
    return Measure(
        name=name,
        title=plugin.title if plugin else name.replace("_", " ").capitalize(),
        unit=plugin.unit if plugin else "",
        low=axis.low if plugin and axis else None,
        high=axis.high if plugin and axis else None,
        scale=axis.scale if plugin and axis else "linear",
    )


def column(name: str) -> ColumnElement[float | None]:
    """Return a measure as a column, so that the database reads the JSON."""
    return Creature.measured["measures", name].as_float()
