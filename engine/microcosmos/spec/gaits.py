"""The spec of a sweep of hand-made gaits over viscosity, and its presets."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import Field, ValidationInfo, model_validator

from ..invalid import InvalidField
from ..plugins import is_plugin
from .base import PAPER, Part, field, refuse_repeated
from .body import Body, PluginBody, Swimmer, SwimmerBody, is_unavailable, resolved
from .coupling import Coupling
from .plugins import OR_PLUGIN, PluginVersion, PluginVersions, pinned
from .scene import Gait, Scene, refuse_too_large
from .search import Task
from .world import Steric, World

VISCOSITIES = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)

Form = Literal["ours", "strong", "paper"]
Viscosity = Annotated[float, Field(ge=1e-3, le=2.0, json_schema_extra={"unit": "cells²/step"})]


class Gaits(Part):
    """Swimmers with hand-made gaits, at every viscosity."""

    experiment: Literal["gaits"] = "gaits"
    swimmers: tuple[Annotated[Swimmer, *OR_PLUGIN], ...] = field(
        get_args(Swimmer), min_length=1, source=PAPER
    )
    """Swimmers."""
    forms: Annotated[tuple[Form, ...], Field(min_length=1)] = ("ours", "strong", "paper")
    """Forms of the coupling: ours, ours with actuators of constant strength, the paper's."""
    viscosities: Annotated[tuple[Viscosity, ...], Field(min_length=1, max_length=256)] = (
        VISCOSITIES
    )
    """Kinematic viscosities."""
    width: int = field(64, ge=64, le=2048, unit="cells")
    """Width of the box (x)."""
    height: int = field(64, ge=64, le=2048, unit="cells")
    """Height of the box (y)."""
    period: int = field(1200, ge=20, le=100_000, unit="steps")
    """Steps per stroke."""
    cycles: int = field(3, ge=1, le=100, unit="strokes")
    """Number of strokes; displacement is measured over the last one."""
    ramp: float = field(1.0, ge=0.0, le=100.0, unit="periods")
    """Time in which the stroke grows from zero to its full amplitude; 0: at once."""
    block: int = field(4, ge=1, le=256, unit="points")
    """Points per call of the compiled program; the exact bits of results depend on it."""
    nu_c: float = field(0.1, gt=0.0, le=1e3, unit="cells²/step")
    """Viscosity at which actuators have half their strength, in the form `ours`."""
    steric: Steric | None = None
    """Repulsion between nodes; empty: none."""
    plugins: PluginVersions = Field(default={})
    """Versions of the plug-in gaits, by name."""

    @model_validator(mode="before")
    @classmethod
    def complete(cls, given: Any, info: ValidationInfo) -> Any:
        """Pin the plug-ins among the swimmers."""
        if not isinstance(given, dict):
            return given
        swimmers, held = given.get("swimmers"), given.get("plugins") or {}
        names = [n for n in swimmers if is_plugin(n)] if isinstance(swimmers, Sequence) else []
        if not names and not held:
            return given
        if not isinstance(held, dict):
            raise InvalidField(
                "plugins", f"must be an object of gaits by name, got {held!r:.80}"
            )
        versions = {n: pinned(("gait",), "swimmers", n, held.get(n), info)[0] for n in names}
        return {**given, "plugins": versions}

    @model_validator(mode="after")
    def check(self) -> Self:
        for name in ("swimmers", "forms", "viscosities"):
            refuse_repeated(name, getattr(self, name))
        box = World(width=self.width, height=self.height)
        for swimmer in self.swimmers:
            refuse_too_large(box, swimmer_body(swimmer, self.plugins.get(swimmer)), 0.1)
        return self

    @property
    def generations(self) -> int:
        """Return one per form and swimmer, with all viscosities."""
        return len(self.strokes)

    @property
    def strokes(self) -> tuple[tuple[str, str], ...]:
        """Return every form with every swimmer."""
        return tuple((form, swimmer) for form in self.forms for swimmer in self.swimmers)

    def scene(self, form: str, swimmer: str, viscosity: float) -> Scene:
        """Return the scene of one point of the sweep."""
        plugin = self.plugins.get(swimmer)
        width, height, steric = self.width, self.height, self.steric
        gait = {"swimmer": swimmer, "period": self.period, "ramp": self.ramp, "plugin": plugin}
        return Scene(
            world=World(width=width, height=height, viscosity=viscosity, steric=steric),
            body=swimmer_body(swimmer, plugin),
            coupling=self.coupling(form),
            control=Gait.model_validate(gait),
            task=Task(steps=self.period * self.cycles, fitness="displacement"),
        )

    def coupling(self, form: str) -> Coupling:
        """Return the coupling of a form; all have the same delta."""
        if form == "paper":
            return Coupling(projection="none", theta_feedback=0, layers=2, kernel="peskin")
        # Peskin's delta as in the paper, so that the forms differ in the coupling alone
        # (docs/physics.md).
        return Coupling(nu_c=self.nu_c if form == "ours" else None, kernel="peskin")


def swimmer_body(swimmer: str, plugin: PluginVersion | None = None) -> Body:
    """Return the body of a swimmer."""
    if plugin is None:
        return SwimmerBody.model_validate({"builder": swimmer})
    body = PluginBody(builder=swimmer, plugin=plugin)
    return body if is_unavailable(body) else resolved(body)


PRESETS = {
    "demo": (
        "Worm and ray at three viscosities, seconds on a laptop; no limit acts",
        Gaits(
            swimmers=("worm", "ray"),
            forms=("ours",),
            viscosities=(0.05, 0.5, 2.0),
            period=600,
            cycles=2,
        ),
    ),
    "paper": ("The paper's sweep: five swimmers, viscosity 0.001 to 2, three forms", Gaits()),
}
