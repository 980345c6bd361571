"""The common part of the specs of searches."""

from abc import abstractmethod
from typing import Any, Generic, Self, TypeVar

from pydantic import model_validator

from .base import Part, field
from .body import Body, Chain, is_unavailable, resolved
from .containers import Fronts
from .control import Control, Genome
from .coupling import Coupling, refuse_without_feasible
from .emitters import (
    STATELESS,
    Emitter,
    PopulationEmitter,
    gradients,
    refuse_unfit_emitters,
)
from .encodings import Controller, refuse_cramped
from .measures import MEASURES
from .placement import refuse_blocked, refuse_crowded
from .scene import Scene, refuse_misfit, refuse_senseless, refuse_swept
from .search import MEASURED, Archive, Generations, Task
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
        refuse_crowded(self.world, self.body, self.task)
        refuse_blocked(self.world, self.body, self.task)
        refuse_senseless(self.world, self.control, self.task)
        again = self.search.reevaluation
        posed = self.world.solid is None and self.world.copies is None
        if again is not None and again.pose and not posed:
            raise ValueError(
                "`search.reevaluation.pose` must be false where the world has obstacles, walls "
                "or copies, which a body in a random pose may start in; got true"
            )
        refuse_unfit_emitters(self.emitters, self.control.encoding)
        if self.search.feasible:
            refuse_without_feasible(self.coupling, "search.feasible")
        return self

    @model_validator(mode="after")
    def check_initial(self) -> Self:
        emitters, batch, initial = self.emitters, self.search.batch, len(self.search.initial)
        populations = [one for one in emitters if isinstance(one, PopulationEmitter)]
        if not initial or not populations:
            return self
        if len(emitters) > 1 or populations[0].backend != "microcosmos":
            raise ValueError(
                "`search.initial` must be empty for a population beside other emitters or with "
                f"another program's backend, got {initial} creatures"
            )
        if initial > batch:
            raise ValueError(
                f"`search.initial` must have at most `search.batch` ({batch}) creatures for a "
                f"population, got {initial}"
            )
        return self

    @model_validator(mode="after")
    def check_container(self) -> Self:
        """Raise `ValueError` for what needs one elite in each cell, where there is not."""
        container = self.archive.container
        if container is None:
            return self
        recorded = {*MEASURES, *self.archive.plugins}
        recorded |= {self.task.fitness} if self.task.plugin else set()
        for name in getattr(container, "measures", ()):
            if name not in recorded:
                raise ValueError(
                    "`archive.container.measures` must be recorded, those of plug-ins as a "
                    f"descriptor or the fitness, got {name!r}"
                )
        if getattr(self.search, "screening", None):
            raise ValueError(
                "`search.screening` must be empty with `archive.container`, got settings"
            )
        if self.search.reevaluation and self.search.reevaluation.decides:
            raise ValueError(
                "`search.reevaluation.decides` must be false with `archive.container`, got true"
            )
        allowed = (*STATELESS, "population")
        for emitter in self.emitters:
            if emitter.operator not in allowed:
                raise ValueError(
                    f"`search.emitters` must be among {', '.join(allowed)} with "
                    f"`archive.container`, got {emitter.operator!r}, which learns from cells"
                )
        if isinstance(container, Fronts):
            fitness = self.task.fitness
            if container.measure == MEASURED.get(fitness, (fitness,))[0]:
                raise ValueError(
                    "`archive.container.measure` must be another measure than that of the "
                    f"fitness {fitness!r}, got {container.measure!r}"
                )
        return self

    @property
    def generations(self) -> int:
        """Return the generations of the whole run."""
        return self.search.generations

    @property
    @abstractmethod
    def emitters(self) -> tuple[Emitter | PopulationEmitter, ...]:
        """Return the sources of offspring."""

    @property
    @abstractmethod
    def slots(self) -> tuple[int, ...]:
        """Return the offspring per generation of each emitter."""

    @property
    def gradients(self) -> tuple[int, ...]:
        """Return the gradients per generation that each emitter needs."""
        return tuple(map(gradients, self.emitters, self.slots))

    @property
    def scene(self) -> Scene:
        """Return the scene of every creature."""
        return Scene(
            world=self.world,
            body=self.body if is_unavailable(self.body) else resolved(self.body),
            coupling=self.coupling,
            control=self.control,
            task=self.task,
            plugins=self.archive.plugins,
        )
