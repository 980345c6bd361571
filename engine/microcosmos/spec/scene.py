"""Scenes: the world, body, coupling, controller and task of one creature."""

from math import ceil
from typing import Annotated, Any, Literal, Self

from pydantic import Field, Tag, model_validator
from pydantic.json_schema import SkipJsonSchema

from ..bodies import extent
from .base import ENCODINGS, Part, field, name_in, one_of
from .body import SUPPORT, Body, Chain, GrownBody, Swimmer, is_unavailable, shape
from .control import Control, NetworkInputs
from .coupling import Coupling
from .encodings import (
    BodyGraph,
    Controller,
    Direct,
    Grown,
    PluginControl,
    Weights,
    max_stretch,
    refuse_unfit,
)
from .placement import refuse_blocked, refuse_crowded
from .plugins import OR_PLUGIN, MaybePlugin, PluginVersions, complete_plugin
from .search import STROKED, Task
from .world import World


class Gait(Part):
    """The hand-made gait of a swimmer."""

    swimmer: Annotated[Swimmer, *OR_PLUGIN]
    """Name of the swimmer."""
    period: int = field(1200, ge=20, le=1_000_000, unit="steps")
    """Steps per stroke."""
    ramp: float = field(1.0, ge=0.0, le=100.0, unit="periods")
    """Time in which the stroke grows from zero to its full amplitude; 0: at once."""
    plugin: MaybePlugin = None

    complete = complete_plugin(("gait",), "swimmer")


class Fold(Part):
    """A rest shape that stays constant."""

    encoding: Literal["fold"] = "fold"
    lengths: Literal["log", "raw"] = "log"
    """Genes of rest lengths: logarithms of factors, which keep lengths positive, or cells that
    are added, as in the paper."""


def _encoding(control: Any) -> Any:
    if isinstance(control, Gait) or (isinstance(control, dict) and "swimmer" in control):
        return "gait"
    return name_in("encoding", "cppn")(control)


class Scene(Part):
    """Everything that is simulated for one creature."""

    world: World = World()
    body: Body = Chain()
    coupling: Coupling = Coupling()
    control: Annotated[
        Annotated[Control, Tag("cppn")]
        | Annotated[Direct, Tag("direct")]
        | Annotated[Weights, Tag("weights")]
        | Annotated[Grown, Tag("cppn-body")]
        | Annotated[BodyGraph, Tag("body-graph")]
        | Annotated[Gait, Tag("gait")]
        | Annotated[Fold, Tag("fold")]
        | Annotated[SkipJsonSchema[PluginControl], Tag("plugin")],
        *one_of("encoding", ENCODINGS[:-1], _encoding),
    ] = Control()
    task: Task = Task()
    plugins: PluginVersions = Field(default={})
    """Versions of the plug-in measures that are recorded beside the built-in ones."""

    @model_validator(mode="after")
    def check(self) -> Self:
        refuse_senseless(self.world, self.control, self.task)
        if isinstance(self.control, Fold) and isinstance(self.body, GrownBody):
            raise ValueError("`body` must have a fixed graph to be folded, got 'grown'")
        refuse_swept(self.coupling, self.body)
        if isinstance(self.control, Fold):  # It may overlap itself and reach around the box.
            return self
        refuse_crowded(self.world, self.body, self.task)
        refuse_blocked(self.world, self.body, self.task)
        if not isinstance(self.control, Gait):
            refuse_misfit(self.world, self.body, self.control)
            return self
        refuse_too_large(self.world, self.body, 0.0)
        if self.control.plugin:  # Its body may already be a graph.
            return self
        if self.body.builder != self.control.swimmer:
            raise ValueError(
                f"`body.builder` must be {self.control.swimmer!r} for its gait, "
                f"got {self.body.builder!r}"
            )
        return self


def refuse_swept(coupling: Coupling, body: Body) -> None:
    """Raise `ValueError` where a grown body would need sweeps over its constraints."""
    if not isinstance(body, GrownBody):
        return
    for name, needed in (("nu_c", None), ("theta_feedback", 1)):
        if (found := getattr(coupling, name)) != needed:
            raise ValueError(
                f"`coupling.{name}` must be {'empty' if needed is None else needed} where "
                f"`body.builder` is 'grown': its constraints are met in closed form, got "
                f"{found:g}"
            )


def refuse_misfit(world: World, body: Body, control: Controller) -> None:
    """Raise `ValueError` where body, controller and world do not fit each other."""
    refuse_unfit(control, body)
    refuse_too_large(world, body, max_stretch(control))


def refuse_too_large(world: World, body: Body, stretch: float) -> None:
    """Raise `ValueError` where the stretched body, turned any way, does not fit the world."""
    if is_unavailable(body):  # A worker that can build it checks it.
        return
    longest = extent(shape(body))
    needed = ceil(longest * (1 + stretch) + SUPPORT)
    side = "width" if world.width <= world.height else "height"
    if needed > getattr(world, side):
        raise ValueError(
            f"`world.{side}` must be at least {needed} cells for a `body` that reaches "
            f"{longest:.4g} cells, stretched by up to {stretch:g}; got {getattr(world, side)}"
        )


def refuse_senseless(world: World, control: Controller | Gait | Fold, task: Task) -> None:
    """Raise `ValueError` where the task or the controller needs what the world lacks."""
    senses = isinstance(control, NetworkInputs) and control.sense_energy
    if senses and world.copies is not None:
        raise ValueError(
            "`control.sense_energy` must be false where `world.copies` is set: copies have the "
            "commands of one; got true"
        )
    if task.fitness in STROKED and getattr(control, "timer", "") == "linear":
        raise ValueError(
            f"`task.fitness` must not be {task.fitness!r} where `control.timer` is 'linear': "
            "without a period there are no strokes"
        )
    channel = world.flow is not None and world.flow.kind == "poiseuille"
    if task.fitness == "upstream" and not channel:
        got = "none" if world.flow is None else world.flow.kind
        raise ValueError(
            "`world.flow` must be 'poiseuille', which has a direction, where `task.fitness` is "
            f"'upstream'; got {got}"
        )
    if task.fitness == "through" and not world.obstacles:
        raise ValueError(
            "`world.obstacles` must hold some where `task.fitness` is 'through'; got none"
        )
    collects = task.plugin is None and "energy" in task.fitness
    if world.energy is None and (senses or collects):
        path = "control.sense_energy" if senses else "task.fitness"
        value = True if senses else task.fitness
        raise ValueError(f"`world.energy` must be set where `{path}` is {value!r}; got none")
