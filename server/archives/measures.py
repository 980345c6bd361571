"""What is recorded of elites, by name, and the axes that an archive has of it."""

from collections.abc import Sequence
from dataclasses import asdict
from math import prod
from typing import Literal

from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from microcosmos.spec import PluginVersion, plugins_in
from microcosmos.spec.measures import MEASURES

from ..core.errors import ProblemError
from ..core.schemas import FieldError
from ..tables import Creature, Elite, Run
from .schemas import Axis, Measure


def searched(run: Run) -> bool:
    """Whether it fills an archive; others measure, and their result is a table."""
    return "search" in run.spec


def axes(run: Run) -> list[Axis]:
    """The archive's own axes."""
    described = run.spec["archive"]["descriptors"]
    return [Axis(**{name: axis[name] for name in Axis.model_fields}) for axis in described]


def kind(run: Run) -> tuple[Literal["grid", "cvt"], int]:
    """What the cells of the archive are, and how many."""
    centroids = run.spec["archive"].get("centroids")
    if centroids is not None:
        return "cvt", centroids
    return "grid", prod(axis.bins for axis in axes(run))


def recorded(session: Session, run: Run) -> list[Measure]:
    """What was measured of the run's elites; of a run without any, what will be."""
    one = select(Creature.measured).join(Elite, Elite.creature == Creature.sha256)
    measured = session.scalars(one.where(Elite.run_id == run.id).limit(1)).first()
    names = measured["measures"] if measured else list(MEASURES)
    mine = {one.name: one.version for one in plugins_in(run.spec)}
    ends = {axis.name: axis for axis in axes(run)}
    return [
        _told(name, mine.get(name), ends.get(name))
        for name in dict.fromkeys((*names, *_plugin_axes(run)))
    ]


def _plugin_axes(run: Run) -> list[str]:
    """Names of plug-in descriptors, which are recorded as well."""
    return [axis["name"] for axis in run.spec["archive"]["descriptors"] if axis.get("plugin")]


def _told(name: str, plugin: PluginVersion | None, axis: Axis | None) -> Measure:
    """A measure under its title; one that is not known any more is told by its name."""
    known = MEASURES.get(name)
    if plugin is not None:
        low, high = (axis.low, axis.high) if axis else (None, None)
        scale = axis.scale if axis else "linear"
        return Measure(
            name=name, title=plugin.title, unit=plugin.unit, low=low, high=high, scale=scale
        )
    if known is None:
        title = name.replace("_", " ").capitalize()
        return Measure(name=name, title=title, unit="", low=None, high=None, scale="linear")
    return Measure(name=name, **asdict(known))


def column(name: str) -> ColumnElement[float | None]:
    """A measure of a creature, read by the database: most of what was measured stays there."""
    return Creature.measured["measures", name].as_float()


def refuse_unknown(names: Sequence[str], known: Sequence[Measure]) -> None:
    """Raise `ProblemError` where a name is of nothing that was recorded."""
    there = [measure.name for measure in known]
    if wrong := [name for name in names if name not in there]:
        needed = f"names among {', '.join(there)}"
        detail = f"`measures` must be {needed}; got {', '.join(map(repr, wrong))}."
        error = FieldError(field="measures", message=detail, needed=needed, got=wrong)
        raise ProblemError(422, "Invalid input", detail, [error])
