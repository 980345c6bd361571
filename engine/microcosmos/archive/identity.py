"""Everything that a creature is, as it is written and named."""

from typing import Literal, Self

from pydantic import Field, model_validator

from ..spec import Body, Coupling, Gait, Part, Scene, Task, World
from .genomes import CPPN, Direct, Fold, Grown, Stroke, Weights


class PlacedWorld(World):
    """The world with the form of the coupling, both of which a creature's numbers depend on."""

    coupling: Coupling


class Identity(Part):
    """Everything that a creature is."""

    format: Literal["microcosmos-creature/1"]
    genome: CPPN | Direct | Weights | Grown | Stroke | Fold = Field(discriminator="encoding")
    world: PlacedWorld
    body: Body
    task: Task

    @model_validator(mode="after")
    def check_fit(self) -> Self:
        scene = self.scene
        if isinstance(self.genome, Direct | Weights | Fold):
            self.genome.refuse_other_length(scene.body)
        return self

    @property
    def scene(self) -> Scene:
        """What is simulated."""
        world, genome = self.world.model_dump(), self.genome
        gait = isinstance(genome, Stroke)
        control = Gait(**genome.model_dump(exclude={"encoding"})) if gait else genome.control
        return Scene(
            coupling=world.pop("coupling"),
            world=World(**world),
            body=self.body,
            control=control,
            task=self.task,
        )
