"""Sentences in physical units for captions of groups of runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...archive.quantities import Real, like, shown, square
from ...exports import si
from ...exports.run_file import fitness_of
from ...statistics import Comparison
from ...statistics.effects import quartiles
from ...statistics.measures import values_of
from .caption import NAMES
from .groups import Group
from .reading import plugins_of

MOST = 6
"""Groups whose numbers a caption states one by one."""
OF_FITNESS = ("best", "mean")
"""Curves in the unit of fitness. A QD score adds up elites: it is no speed of anything."""


@dataclass(frozen=True)
class Stated:
    """A number in the unit of fitness, of each group."""

    title: str
    values: Sequence[float]


def of_curves(groups: Sequence[Group], shown_curves: Sequence[str], real: Real) -> str:
    """Return a sentence on the last medians of curves over the seeds of each group.

    Raises `ValueError` for a run without a fluid or a stroke.
    """
    stated = [
        Stated(
            f"median {NAMES.get(name, f'{name} fitness')} at the end",
            [
                quartiles(np.array([values_of(run.curves, name)[-1] for run in one.runs]))[1]
                for one in groups
            ],
        )
        for name in shown_curves
        if name in OF_FITNESS
    ]
    return _sentence(
        [one.label for one in groups], [one.runs[0] for one in groups], stated, real
    )


def of_comparison(found: Comparison, real: Real) -> str:
    """Return a sentence on the medians, and on values to reach, of compared groups.

    Raises `ValueError` for a run without a fluid or a stroke.
    """
    stated = []
    for result in found.results:
        measure = result.measure
        if measure.curve not in OF_FITNESS:
            continue
        if measure.reaches is None:
            values = [one.median for one in result.summaries]
            stated.append(Stated(f"median {measure.title}", values))
        else:
            name = NAMES.get(measure.curve, f"{measure.curve} fitness")
            values = [measure.reaches] * len(found.groups)
            stated.append(Stated(f"{name} of {measure.reaches:g}", values))
    names = [one.name for one in found.groups]
    return _sentence(names, [one.runs[0] for one in found.groups], stated, real)


def _sentence(
    names: Sequence[str], runs: Sequence[Any], stated: Sequence[Stated], real: Real
) -> str:
    scaled = [si.of_scene(run.spec.scene, real) for run in runs]
    fluids = [one.viscosity(run.spec.scene) for one, run in zip(scaled, runs, strict=True)]
    parts = []
    for one in stated:
        texts = {
            name: _shown(value, run, of_run)
            for name, value, run, of_run in zip(names, one.values, runs, scaled, strict=True)
            if np.isfinite(value)  # Others have no elites.
        }
        if texts and all(texts.values()):
            parts.append(f"the {one.title} is {_each(texts, len(texts) < len(names))}")
    if all(fluid is not None for fluid in fluids):
        known = [f"{square(fluid)}, {like(fluid)}" for fluid in fluids if fluid is not None]
        parts.append(
            f"the kinematic viscosity is {_each(dict(zip(names, known, strict=True)))}"
        )
    given = (
        f"With a body of {shown(real.length, 'm')} and a stroke of {shown(real.period, 's')}"
    )
    if not parts:
        return f" {given}, no number of this figure has a physical unit."
    whole = ", and ".join(["; ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)
    return f" {given}, {whole}."


def _shown(value: float, run: Any, scaled: si.Scaled) -> str:
    """Return a number in the unit of fitness in SI units; empty where it has no dimension."""
    spec = run.spec
    unit = si.UNITS.get(fitness_of(spec.task.model_dump(), plugins_of(spec)))
    factor = None if unit is None else scaled.factor(unit)
    if unit is None or factor is None:
        return ""
    return f"{shown(value * float(factor), unit.si)}{unit.about}"


def _each(texts: Mapping[str, str], named: bool = False) -> str:
    """Return one text, one for each group by name, or the first and the last of many.

    A text of all groups has no names, unless it is `named`.
    """
    if len(set(texts.values())) == 1 and not named:
        return next(iter(texts.values()))
    each = [f"{text} ({name})" for name, text in texts.items()]
    return f"{each[0]} to {each[-1]}" if len(each) > MOST else ", ".join(each)
