"""Everything that a creature is, as it is written and named."""

from typing import Literal, Self

from pydantic import Field, model_validator

from ..spec import OUTPUTS, Body, Control, Coupling, Gait, Part, Scene, Task, World
from .cppn_genes import Connections, Nodes, check_genes


class CPPN(Part):
    """The genes of a controller, without unused room, in the order of their numbers."""

    encoding: Literal["cppn"]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    control: Control
    nodes: Nodes
    connections: Connections

    @model_validator(mode="after")
    def check(self) -> Self:
        if self.inputs != self.control.inputs:
            raise ValueError(
                f"`inputs` must be {list(self.control.inputs)}, got {list(self.inputs)}"
            )
        if self.outputs != OUTPUTS:
            raise ValueError(f"`outputs` must be {list(OUTPUTS)}, got {list(self.outputs)}")
        check_genes(len(self.inputs), len(self.outputs), self.nodes, self.connections)
        return self


class Stroke(Gait):
    """A hand-made gait in the place of genes."""

    encoding: Literal["gait"]


class PlacedWorld(World):
    """The world with the form of the coupling, both of which a creature's numbers depend on."""

    coupling: Coupling


class Identity(Part):
    """Everything that a creature is."""

    format: Literal["microcosmos-creature/1"]
    genome: CPPN | Stroke = Field(discriminator="encoding")
    world: PlacedWorld
    body: Body
    task: Task

    @model_validator(mode="after")
    def check_fit(self) -> Self:
        _ = self.scene
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
