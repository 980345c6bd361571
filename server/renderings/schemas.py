"""Wire types of renderings and measurements."""

from typing import Literal

from ..core.schemas import Wire


class Rendering(Wire):
    status: Literal["rendering"] = "rendering"


class Verdict(Wire):
    """The verdict of a creature's audit."""

    trusted: bool | None
    """Null without an audit."""


class Comparison(Wire):
    """A recorded figure and the same one measured here; None if it is not finite."""

    name: str
    recorded: float
    measured: float | None


class Measurement(Wire):
    """The result of evaluating a creature again with the program that measured it."""

    creature: str
    exact: bool
    """Every recorded figure is the same to the bit."""
    device: str
    recorded_device: str
    fitness: Comparison
    figures: list[Comparison]
    """Those that differ, the largest relative difference first."""
