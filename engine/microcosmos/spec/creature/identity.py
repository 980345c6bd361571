"""The identity of a creature, whose SHA-256 is its name."""

from typing import Annotated, Literal, Self

from pydantic import Tag, model_validator

from ... import bodies
from ..base import ENCODINGS, Part, name_in, one_of
from ..body import Body, GrownBody, PluginBody, shape
from ..coupling import Coupling
from ..scene import Gait, Scene
from ..search import Task
from ..world import World
from .genomes import CPPN, BodyGraph, Direct, Fold, GaitGenome, Grown, PluginGenome, Weights

Genome = Annotated[
    Annotated[CPPN, Tag("cppn")]
    | Annotated[Direct, Tag("direct")]
    | Annotated[Weights, Tag("weights")]
    | Annotated[Grown, Tag("cppn-body")]
    | Annotated[BodyGraph, Tag("body-graph")]
    | Annotated[GaitGenome, Tag("gait")]
    | Annotated[Fold, Tag("fold")]
    | Annotated[PluginGenome, Tag("plugin")],
    *one_of("encoding", ENCODINGS[:-1], name_in("encoding")),
]


class CoupledWorld(World):
    """The world and the coupling, on both of which a creature's measures depend."""

    coupling: Coupling


class Identity(Part):
    """Genome, world, body and task of a creature."""

    format: Literal["microcosmos-creature/1"]
    genome: Genome
    world: CoupledWorld
    body: Body
    task: Task

    @model_validator(mode="after")
    def check_fit(self) -> Self:
        scene = self.scene
        if isinstance(self.body, PluginBody):
            raise ValueError(f"`body` must be a graph, got {self.body.builder!r}")
        if isinstance(self.genome, Direct | Weights | Fold | PluginGenome):
            self.genome.refuse_other_length(scene.body)
        if isinstance(self.genome, BodyGraph):
            assert isinstance(scene.body, GrownBody)  # Else the scene would not be valid.
            self.genome.plan.refuse_unfit(scene.body)
        return self

    @property
    def shape(self) -> bodies.Body:
        """Return the graph of the body at rest; that of a plan as it has grown."""
        genome, body = self.genome, self.body
        if isinstance(genome, BodyGraph) and isinstance(body, GrownBody):
            return genome.plan.grow(body, genome.control.softest)
        return shape(body)

    @property
    def scene(self) -> Scene:
        """Return the scene that is simulated."""
        world, genome = self.world.model_dump(), self.genome
        gait = isinstance(genome, GaitGenome)
        control = Gait(**genome.model_dump(exclude={"encoding"})) if gait else genome.control
        return Scene(
            coupling=world.pop("coupling"),
            world=World(**world),
            body=self.body,
            control=control,
            task=self.task,
        )
