"""The common part of the specs of searches."""

from abc import abstractmethod
from math import ceil
from typing import Any, Generic, Self, TypeVar

from pydantic import model_validator

from ..invalid import InvalidField
from ..measures import RECORDED
from .base import Part, field, refuse
from .body import Body, Chain, is_unavailable, resolved
from .containers import Fronts
from .control import Control, Genome
from .coupling import Coupling, refuse_without_feasible
from .emitters import BUILT_IN, Emitter, refuse_initial, refuse_unfit_emitters
from .encodings import Controller, refuse_cramped
from .scene import (
    Scene,
    refuse_blocked,
    refuse_crowded,
    refuse_misfit,
    refuse_senseless,
    refuse_swept,
)
from .search import MEASURED, STROKED, Archive, Generations, Task
from .world import Steric, World

Name = TypeVar("Name", bound=str)
SearchSpec = TypeVar("SearchSpec", bound=Generations)

SMALL: dict[str, Any] = {
    "control": Control(period=180, angle_scale=0.6),
    "task": Task(steps=1200),
}
"""Parts of the demonstrations."""

UNLIMITED: dict[str, Any] = {"max_speed": None, "lag": 0, "max_bend": None}
"""Actuators that carry out any command at once."""

LITERAL: dict[str, Any] = {
    "world": World(width=64, height=64, steric=Steric()),
    "body": Chain(nodes=32),
    "coupling": Coupling(projection="none", theta_feedback=0, layers=2, kernel="peskin"),
    "control": Control(
        timer="linear",
        position="unit",
        wave_number=None,
        period=100,
        angle_scale=0.5,
        length_scale=0.3,
        **UNLIMITED,
    ),
    "task": Task(steps=500, fitness="displacement"),
}
"""Parts as in the paper."""


def refuse_strokeless(control: Controller, task: Task) -> None:
    """Raise `ValueError` where no creature could complete the strokes that fitness counts."""
    period = getattr(control, "period", 0.0)
    least = ceil(2 * period)
    refuse(
        task.fitness in STROKED and task.steps < least,
        "task.steps",
        f"must be at least {least}, two strokes of `control.period` {period:g}, where "
        f"`task.fitness` is {task.fitness!r}, which leaves out the first; got {task.steps}",
        least=least,
    )


class Evolution(Part, Generic[Name, SearchSpec]):
    """A search over generations of creatures in one scene, with an archive of elites."""

    experiment: Name
    seed: int = field(0, ge=0, lt=2**32)
    """Random seed."""
    world: World = World()
    body: Body = Chain()
    """Body at rest."""
    coupling: Coupling = Coupling()
    control: Controller = Control()
    """Controller of rest angles and rest lengths; its genome is inherited."""
    genome: Genome = Genome()
    task: Task = Task()
    archive: Archive = Archive()
    """Archive: the fittest creature (elite) of each cell."""
    search: SearchSpec

    @model_validator(mode="after")
    def check_scene(self) -> Self:
        refuse_misfit(self.world, self.body, self.control)
        refuse_swept(self.coupling, self.body)
        refuse_cramped(self.control, self.genome)
        refuse_crowded(self.world, self.body, self.control, self.task)
        refuse_blocked(self.world, self.body, self.control, self.task)
        refuse_senseless(self.world, self.control, self.task)
        refuse_strokeless(self.control, self.task)
        again = self.search.reevaluation
        posed = self.world.solid is None and self.world.copies is None
        refuse(
            again is not None and again.pose and not posed,
            "search.reevaluation.pose",
            "must be false where the world has obstacles, walls "
            "or copies, which a body in a random pose may start in; got true",
        )
        refuse_unfit_emitters(self.emitters, self.control.encoding)
        if self.search.feasible:
            refuse_without_feasible(self.coupling, "search.feasible")
        refuse_initial(self.emitters, len(self.search.initial), self.search.batch)
        return self

    @model_validator(mode="after")
    def check_container(self) -> Self:
        """Raise `ValueError` where the search needs one elite in each cell and has none."""
        container = self.archive.container
        if container is None:
            return self
        recorded = {*RECORDED, *self.archive.named, *self.archive.plugins}
        recorded |= {self.task.fitness} if self.task.plugin else set()
        for name in getattr(container, "measures", ()):
            refuse(
                name not in recorded,
                "archive.container.measures",
                "must be recorded, those of plug-ins as a "
                f"descriptor or the fitness, got {name!r}",
            )
        refuse(
            getattr(self.search, "screening", None),
            "search.screening",
            "must be empty with `archive.container`, got settings",
        )
        for emitter in self.emitters:
            if emitter.emits.learns == "cells":
                allowed = [n for n, one in BUILT_IN.items() if one.emits.learns != "cells"]
                raise InvalidField(
                    "search.emitters",
                    f"must be among {', '.join(allowed)} with "
                    f"`archive.container`, got {emitter.operator!r}, which learns from cells",
                )
        if isinstance(container, Fronts):
            fitness = self.task.fitness
            refuse(
                container.measure == MEASURED.get(fitness, (fitness,))[0],
                "archive.container.measure",
                "must be another measure than that of the "
                f"fitness {fitness!r}, got {container.measure!r}",
            )
        return self

    @property
    def generations(self) -> int:
        """Return the generations of the whole run."""
        return self.search.generations

    @property
    @abstractmethod
    def emitters(self) -> tuple[Emitter, ...]:
        """Return the sources of offspring."""

    @property
    @abstractmethod
    def slots(self) -> tuple[int, ...]:
        """Return the offspring per generation of each emitter."""

    @property
    def gradients(self) -> tuple[int, ...]:
        """Return the gradients per generation that each emitter needs."""
        return tuple(emitter.emits.gradients for emitter in self.emitters)

    @property
    def scene(self) -> Scene:
        """Return the scene of every creature."""
        return Scene(
            world=self.world,
            body=self.body if is_unavailable(self.body) else resolved(self.body),
            coupling=self.coupling,
            control=self.control,
            task=self.task,
            measures=self.archive.named,
            plugins=self.archive.plugins,
        )
