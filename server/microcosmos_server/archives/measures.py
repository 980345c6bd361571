"""Recorded measures of elites, and the axes of an archive."""

from dataclasses import asdict
from math import prod
from typing import Literal

from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from microcosmos.archive.measured import described, of_creature
from microcosmos.measures import RECORDED
from microcosmos.spec import Archive, plugins_in

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
    names = of_creature(measured) or RECORDED
    own = [axis["name"] for axis in run.spec["archive"]["descriptors"]]
    versions = {one.name: one.version for one in plugins_in(run.spec)}
    ends = {axis.name: axis for axis in axes(run)}
    return [
        Measure(**asdict(described(name, versions, ends)))
        for name in dict.fromkeys((*names, *own))
    ]


def column(name: str) -> ColumnElement[float | None]:
    """Return a measure as a column, so that the database reads the JSON."""
    return Creature.measured["measures", name].as_float()
