"""What the specs of searches for creatures have in common."""

from abc import abstractmethod
from typing import Generic, Self, TypeVar

from pydantic import Field, model_validator

from .base import Part
from .body import Body, Chain, made_elsewhere, resolved
from .control import Control, Genome
from .coupling import Coupling
from .emitters import Emitter, PopulationEmitter, gradients, refuse_unfit_emitters
from .encodings import Controller, refuse_cramped
from .scene import Scene, refuse_misfit, refuse_senseless
from .search import Archive, Generations, Task
from .world import World

Name = TypeVar("Name", bound=str)
How = TypeVar("How", bound=Generations)


def refuse_crowd(
    emitters: tuple[Emitter | PopulationEmitter, ...], search: Generations
) -> None:
    """A population of its own must be able to hold all that the search begins from."""
    populations = [one for one in emitters if isinstance(one, PopulationEmitter)]
    if not search.initial or not populations:
        return
    if len(emitters) > 1 or populations[0].backend != "microcosmos":
        raise ValueError(
            "`search.initial` must be empty for a population beside other emitters or with "
            f"another program's backend, got {len(search.initial)} creatures"
        )
    if len(search.initial) > search.batch:
        raise ValueError(
            f"`search.initial` must have at most `search.batch` ({search.batch}) creatures for "
            f"a population, got {len(search.initial)}"
        )


class Evolution(Part, Generic[Name, How]):
    """Generations of creatures that live in one scene, and an archive of the best."""

    experiment: Name
    seed: int = Field(default=0, ge=0, lt=2**32)
    """The one source of randomness."""
    world: World = World()
    body: Body = Chain()
    """The creature at rest, before it is controlled."""
    coupling: Coupling = Coupling()
    control: Controller = Control()
    """What sets rest angles and rest lengths while a creature swims, and is inherited."""
    genome: Genome = Genome()
    task: Task = Task()
    archive: Archive = Archive()
    """Where the best creature of each kind is kept."""
    search: How

    @model_validator(mode="after")
    def check_scene(self) -> Self:
        refuse_misfit(self.world, self.body, self.control)
        refuse_cramped(self.control, self.genome)
        refuse_senseless(self.world, self.control, self.task)
        refuse_unfit_emitters(self.emitters, self.control.encoding)
        return self

    @model_validator(mode="after")
    def check_initial(self) -> Self:
        refuse_crowd(self.emitters, self.search)
        return self

    @property
    def generations(self) -> int:
        """Generations of the whole run."""
        return self.search.generations

    @property
    @abstractmethod
    def emitters(self) -> tuple[Emitter | PopulationEmitter, ...]:
        """Where children come from."""

    @property
    @abstractmethod
    def slots(self) -> tuple[int, ...]:
        """Children of each emitter in a generation."""

    @property
    def gradients(self) -> tuple[int, ...]:
        """Creatures that each emitter asks the slopes of in a generation."""
        return tuple(map(gradients, self.emitters, self.slots))

    @property
    def scene(self) -> Scene:
        """What is simulated for each creature."""
        return Scene(
            world=self.world,
            body=self.body if made_elsewhere(self.body) else resolved(self.body),
            coupling=self.coupling,
            control=self.control,
            task=self.task,
            plugins=self.archive.plugins,
        )
