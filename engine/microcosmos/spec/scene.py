"""Scenes: the world, body, controller and task of a creature, and its place at the start."""

from math import ceil
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, Tag, model_validator
from pydantic.json_schema import SkipJsonSchema

from ..bodies import extent, reach
from ..invalid import InvalidField
from ..measures import MeasureName
from .base import ENCODINGS, Part, enough, field, name_in, one_of, refuse
from .body import SUPPORT, Body, Chain, GrownBody, Swimmer, is_unavailable, shape
from .control import Control, NetworkInputs
from .coupling import Coupling
from .encodings import BodyGraph, Controller, Direct, PluginControl, max_stretch, refuse_unfit
from .plugins import OR_PLUGIN, MaybePlugin, PluginVersions, complete_plugin
from .search import STROKED, Task
from .world import World, crowded, solid_cells

GAP = 3
"""Least distance between copies at the start, in cells."""

CLEARANCE = 2
"""Least distance of a node at the start from the middle of a solid cell, in cells."""


# Half a turn is enough: a filament and its reverse cover the same cells.
EVERY_WAY = np.pi * np.arange(32) / 32
"""Directions of a body that grows, in rad."""


def headings(task: Task) -> np.ndarray:
    """Return the turns of the body about its middle at the start of each trial, in rad."""
    return np.pi / 4 * np.arange(task.trials)


def arms(body: Body, control: Any, task: Task) -> np.ndarray:
    """Return nodes (trial, node, 2) about their mean at the start of each trial, in cells.

    A body that inherits its angles may have any direction: its longest filament, straight, is
    put in all of them. Lengths are the largest that it may inherit.
    """
    graph, turns, factor = shape(body), isinstance(body, GrownBody), 1.0
    nodes = graph.positions
    if isinstance(control, Direct):
        factor = 1.0 if control.rest_length is None else control.rest_length.high
        if control.rest_angle is not None:
            nodes, turns = np.linspace(0, (reach(graph), 0), len(nodes)), True
    nodes = factor * nodes
    if turns:
        nodes = nodes - nodes.mean(0)
        nodes = np.concatenate([nodes @ _turn(angle) for angle in EVERY_WAY])
    return (nodes - nodes.mean(0))[None] @ np.stack([_turn(one) for one in headings(task)])


def _turn(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s], [-s, c]])


def places(world: World) -> np.ndarray:
    """Return the places (copy, 2) of the middles of bodies at the start, in cells."""
    about = np.zeros((1, 2)) if world.copies is None else world.copies.places
    return about + np.array([world.width, world.height]) / 2


def refuse_crowded(world: World, body: Body, control: Any, task: Task) -> None:
    """Raise `ValueError` where copies, in any trial, start too near each other."""
    copies = world.copies
    if copies is None or is_unavailable(body):  # A worker that can build it checks it.
        return
    reach = np.ptp(arms(body, control, task), axis=1).max(0)
    for axis, (count, side) in enumerate(zip(copies.shape, ("width", "height"), strict=True)):
        needed = reach[axis] + GAP
        refuse(
            count > 1 and copies.spacing < needed,
            "world.copies.spacing",
            f"must be at least {enough(needed)} cells for a `body` "
            f"that reaches {reach[axis]:.4g} cells along the {side}; got "
            f"{copies.spacing:.12g}",
            least=float(enough(needed)),
        )
        needed += (count - 1) * copies.spacing
        refuse(
            getattr(world, side) < needed,
            f"world.{side}",
            f"must be at least {ceil(needed)} cells for {copies.count} "
            f"`world.copies`; got {getattr(world, side)}",
            least=ceil(needed),
        )


def refuse_blocked(world: World, body: Body, control: Any, task: Task) -> None:
    """Raise `ValueError` where the body, in any trial, starts in or at an obstacle."""
    solid = world.solid
    if solid is None or is_unavailable(body):  # A worker that can build it checks it.
        return
    middles = places(world)[:, None]
    for number, one in enumerate(arms(body, control, task)):
        nodes = (middles + one[None]).reshape(-1, 2)
        blocked = np.flatnonzero(crowded(nodes, solid, CLEARANCE))
        if len(blocked):
            x, y = nodes[blocked[0]]
            owner = "world.obstacles" if world.obstacles else "world.flow"
            raise InvalidField(
                owner,
                f"must leave {CLEARANCE} cells around the `body`, which "
                f"starts in the middle of the box; got one at node {blocked[0]}, which starts "
                f"at ({x:.4g}, {y:.4g}) in trial {number + 1}",
            )


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
    # A gait has no `encoding`, since it has no genes.
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
        | Annotated[BodyGraph, Tag("body-graph")]
        | Annotated[Gait, Tag("gait")]
        | Annotated[Fold, Tag("fold")]
        | Annotated[SkipJsonSchema[PluginControl], Tag("plugin")],
        *one_of("encoding", ENCODINGS[:-1], _encoding),
    ] = Control()
    task: Task = Task()
    measures: Annotated[
        SkipJsonSchema[tuple[MeasureName, ...]], Field(exclude_if=lambda names: not names)
    ] = ()
    """Names of the measures that are recorded beside those of every evaluation."""
    plugins: PluginVersions = Field(default={})
    """Versions of the plug-in measures that are recorded beside the built-in ones."""

    @model_validator(mode="after")
    def check(self) -> Self:
        refuse_senseless(self.world, self.control, self.task)
        if isinstance(self.control, Fold) and isinstance(self.body, GrownBody):
            raise InvalidField("body", "must have a fixed graph to be folded, got 'grown'")
        refuse_swept(self.coupling, self.body)
        if isinstance(self.control, Fold):  # It may overlap itself and reach around the box.
            return self
        refuse_crowded(self.world, self.body, self.control, self.task)
        refuse_blocked(self.world, self.body, self.control, self.task)
        if not isinstance(self.control, Gait):
            refuse_misfit(self.world, self.body, self.control)
            return self
        refuse_too_large(self.world, self.body, 0.0)
        if self.control.plugin:  # Its body may already be a graph.
            return self
        if self.body.builder != self.control.swimmer:
            raise InvalidField(
                "body.builder",
                f"must be {self.control.swimmer!r} for its gait, got {self.body.builder!r}",
            )
        return self


def refuse_swept(coupling: Coupling, body: Body) -> None:
    """Raise `ValueError` where a grown body would need sweeps over its constraints."""
    if not isinstance(body, GrownBody):
        return
    for name, needed in (("nu_c", None), ("theta_feedback", 1)):
        if (found := getattr(coupling, name)) != needed:
            raise InvalidField(
                f"coupling.{name}",
                f"must be {'empty' if needed is None else needed} where "
                f"`body.builder` is 'grown': its constraints are met in closed form, got "
                f"{found:g}",
            )


def refuse_misfit(world: World, body: Body, control: Controller) -> None:
    """Raise `ValueError` where body, controller and world do not fit each other."""
    # The size first: a body that is too long for the box has too fast actuators too.
    refuse_too_large(world, body, max_stretch(control))
    refuse_unfit(control, body)


def refuse_too_large(world: World, body: Body, stretch: float) -> None:
    """Raise `ValueError` where the stretched body, turned any way, does not fit the world."""
    if is_unavailable(body):  # A worker that can build it checks it.
        return
    graph = shape(body)
    longest, reaches = extent(graph), reach(graph)
    # The box is periodic: a body must not reach its own image. No filament stretches by more
    # than the longest does.
    needed = ceil(longest * (1 + stretch) + (reaches - longest) + SUPPORT)
    side = "width" if world.width <= world.height else "height"
    refuse(
        needed > getattr(world, side),
        f"world.{side}",
        f"must be at least {needed} cells for a `body` that reaches "
        f"{reaches:.4g} cells, stretched by up to {stretch:g}; got {getattr(world, side)}",
        least=needed,
    )


def refuse_senseless(world: World, control: Controller | Gait | Fold, task: Task) -> None:
    """Raise `ValueError` where the task or the controller needs what the world lacks."""
    senses = isinstance(control, NetworkInputs) and control.sense_energy
    refuse(
        senses and world.copies is not None,
        "control.sense_energy",
        "must be false where `world.copies` is set: copies have the commands of one; got true",
    )
    refuse(
        task.fitness in STROKED and getattr(control, "timer", "") == "linear",
        "task.fitness",
        f"must not be {task.fitness!r} where `control.timer` is 'linear': "
        "without a period there are no strokes",
    )
    channel = world.flow is not None and world.flow.kind == "poiseuille"
    if task.fitness == "upstream" and not channel:
        got = "none" if world.flow is None else world.flow.kind
        raise InvalidField(
            "world.flow",
            "must be 'poiseuille', which has a direction, where `task.fitness` is "
            f"'upstream'; got {got}",
        )
    refuse(
        task.fitness == "through" and not world.obstacles,
        "world.obstacles",
        "must hold some where `task.fitness` is 'through'; got none",
    )
    size = world.width, world.height
    refuse(
        task.fitness == "through" and not solid_cells(world.obstacles, size).any(),
        "world.obstacles",
        "must have a solid cell where `task.fitness` is 'through'; got none",
    )
    collects = task.plugin is None and "energy" in task.fitness
    if world.energy is None and (senses or collects):
        path = "control.sense_energy" if senses else "task.fitness"
        value = True if senses else task.fitness
        raise InvalidField("world.energy", f"must be set where `{path}` is {value!r}; got none")
