"""A creature's scene: the world, body, coupling, controller and task that it means."""

from math import ceil
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic.json_schema import SkipJsonSchema

from ..bodies.extent import extent
from .base import Part, unit
from .body import SUPPORT, Body, Chain, Swimmer, made_elsewhere, shape
from .control import Control, Sight
from .coupling import Coupling
from .encodings import (
    Controller,
    Direct,
    Grown,
    PluginControl,
    Weights,
    kind,
    lengthening,
    refuse_unfit,
)
from .plugins import OR_PLUGIN, MaybePlugin, PluginVersions, complete_plugin
from .search import Task
from .world import World


class Gait(Part):
    """A hand-made gait of one of the known swimmers."""

    swimmer: Annotated[Swimmer, *OR_PLUGIN]
    """Whose gait."""
    period: int = Field(default=1200, ge=20, le=1_000_000, json_schema_extra=unit("steps"))
    """Steps of one stroke."""
    ramp: float = Field(default=1.0, ge=0.0, le=100.0, json_schema_extra=unit("periods"))
    """Over how many periods the stroke grows from nothing to its full size; 0: at once."""
    plugin: MaybePlugin = None

    complete = complete_plugin(("gait",), "swimmer")


class Fold(Part):
    """A rest shape that every joint and edge has for life."""

    encoding: Literal["fold"] = "fold"
    lengths: Literal["log", "raw"] = "log"
    """Whether what is inherited of a rest length is the logarithm of a factor, which keeps it
    positive, or cells that are added, as in the paper."""


def _kind(value: Any) -> Any:
    """The tag of a controller or of a gait."""
    if isinstance(value, Gait) or (isinstance(value, dict) and "swimmer" in value):
        return "gait"
    return kind(value)


class Scene(Part):
    """What is simulated for one creature."""

    world: World = World()
    body: Body = Chain()
    coupling: Coupling = Coupling()
    control: Annotated[
        Annotated[Control, Tag("cppn")]
        | Annotated[Direct, Tag("direct")]
        | Annotated[Weights, Tag("weights")]
        | Annotated[Grown, Tag("cppn-body")]
        | Annotated[Gait, Tag("gait")]
        | Annotated[Fold, Tag("fold")]
        | Annotated[SkipJsonSchema[PluginControl], Tag("plugin")],
        Discriminator(_kind),
    ] = Control()
    task: Task = Task()
    plugins: PluginVersions = Field(default={})
    """Versions of the plug-in measures that are recorded beside the built-in ones."""

    @model_validator(mode="after")
    def check(self) -> Self:
        refuse_senseless(self.world, self.control, self.task)
        if isinstance(self.control, Fold):  # Which may lie in heaps and reach around the box.
            return self
        if not isinstance(self.control, Gait):
            refuse_misfit(self.world, self.body, self.control)
            return self
        refuse_too_large(self.world, self.body, 0.0)
        if self.control.plugin:  # Whose body may stand there as the graph that it is.
            return self
        if self.body.builder != self.control.swimmer:
            raise ValueError(
                f"`body.builder` must be {self.control.swimmer!r} for its gait, "
                f"got {self.body.builder!r}"
            )
        return self


def refuse_misfit(world: World, body: Body, control: Controller) -> None:
    """Body and controller must fit each other, and however it acts the body the world."""
    refuse_unfit(control, body)
    refuse_too_large(world, body, lengthening(control))


def refuse_too_large(world: World, body: Body, stretch: float) -> None:
    """However it turns and unfolds, a stretched body and the delta's support must fit in."""
    if made_elsewhere(body):  # Whoever can make it looks.
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
    """Energy must be there to be sensed or to count."""
    senses = isinstance(control, Sight) and control.sense_energy
    collects = task.plugin is None and task.fitness != "displacement"
    if world.energy is None and (senses or collects):
        field = "control.sense_energy" if senses else "task.fitness"
        value = True if senses else task.fitness
        raise ValueError(f"`world.energy` must be there where `{field}` is {value!r}; got none")
