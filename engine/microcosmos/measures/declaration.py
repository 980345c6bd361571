"""Declarations of measures, built in or of plug-ins: title, unit, group and default axis."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import numpy as np

from ..invalid import InvalidField

Scale = Literal["log10", "linear"]
Group = Literal["result", "control", "shape", "form", "network", "flow"]
Source = Literal["motion", "genome", "form", "poses", "trials"]
Recorded = Literal["always", "named", "gaits", "never"]

MARK = "__microcosmos_measure__"
"""The attribute that holds the declaration of a declared function."""

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class Measure:
    """A number that describes a creature, and its default axis as a descriptor."""

    name: str
    title: str
    unit: str
    """A unit of `units.UNITS`, or a unit without a dimension."""
    low: float
    high: float
    scale: Scale = "linear"
    group: Group = "result"
    """The group in which people read it."""
    about: str = ""
    """Description for the documentation."""
    source: Source = "motion"
    """Source of the measure; the native kernel computes those of a motion."""
    recorded: Recorded = "always"
    """`always`: of every evaluation; `named`: where a spec names it; `gaits`: of a hand-made
    stroke; `never`: it follows from the genes alone."""
    gradient: bool = True
    """True if it has a derivative by the genes."""
    of: Callable[[Any], Any] | None = None
    """The JAX function from a `search.Motion`, of measures that have one of their own."""

    def __post_init__(self) -> None:
        refuse_empty_axis(self.low, self.high, self.scale)


def refuse_empty_axis(low: float, high: float, scale: str = "linear", bins: int = 1) -> None:
    """Raise `ValueError` where an axis has no length or no logarithm in single precision, or
    where two of the `bins + 1` edges are equal."""
    if high <= low:
        raise InvalidField("high", f"must be above `low` ({low:g}), got {high:g}")
    if scale == "log10" and low <= 0:
        raise InvalidField("low", f"must be above 0 where `scale` is log10, got {low:g}")
    spaced = np.geomspace if scale == "log10" else np.linspace
    with np.errstate(over="ignore", under="ignore"):
        edges = np.asarray(spaced(low, high, bins + 1)).astype(np.float32)
    for name, end in (("low", edges[0]), ("high", edges[-1])):
        # Devices take numbers below the smallest normal one for 0.
        if not np.isfinite(end) or (scale == "log10" and end < np.finfo(np.float32).tiny):
            raise InvalidField(name, f"must be a number of single precision, got {end:g}")
    if not np.all(np.diff(edges) > 0):
        raise InvalidField(
            "high",
            f"must be further above `low` ({low:.9g}): {bins} bins up to {high:.9g} are too "
            "narrow for single precision",
        )


def descriptor(
    name: str,
    *,
    title: str,
    low: float,
    high: float,
    scale: Scale = "linear",
    unit: str = "",
    group: Group = "result",
) -> Callable[[Function], Function]:
    """Declare a built-in measure: a JAX function from a `search.Motion` to one number.

    `plugins.descriptor` takes the same arguments. A spec that names the measure records it; its
    docstring is the description.
    """

    def mark(function: Function) -> Function:
        described = about(function)
        setattr(
            function,
            MARK,
            Measure(
                name, title, unit, low, high, scale, group, described, "motion", "named",
                of=function,
            ),
        )  # fmt: skip
        return function

    return mark


def about(function: Callable[..., Any]) -> str:
    """Return the first paragraph of a function's docstring, on one line."""
    return " ".join((function.__doc__ or "").split("\n\n")[0].split())
