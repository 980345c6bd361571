"""The creature file: its identity, whose SHA-256 is the creature's name, and its checks."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, StringConstraints, Tag, ValidationError, model_validator

from ... import bodies
from ...invalid import InvalidField
from ...measures import NAMED
from ...naming import LICENCE, name
from ..base import ENCODINGS, Digest, Numeric, Part, invalid_fields, name_in, one_of, refuse
from ..body import Body, GrownBody, PluginBody, shape
from ..coupling import Coupling
from ..plugins import PluginVersions
from ..scene import Gait, Scene
from ..search import MEASURED, Task
from ..world import World
from .genomes import CPPN, BodyGraph, Direct, Fold, GaitGenome, Network, PluginGenome

Genome = Annotated[
    Annotated[CPPN, Tag("cppn")]
    | Annotated[Direct, Tag("direct")]
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
            raise InvalidField("body", f"must be a graph, got {self.body.builder!r}")
        if isinstance(self.genome, Direct | Fold | PluginGenome):
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


Room = Annotated[int, Field(ge=8, le=8192), Numeric]
Line = StringConstraints(strip_whitespace=True, min_length=1)
Name = Annotated[str, Line, StringConstraints(max_length=200)]
# Terms of descendants join those of all creatures that a run began from: no limit fits.
Licence = Annotated[str, Line]
Label = Annotated[str, StringConstraints(max_length=200)]
Figures = Annotated[dict[Label, Annotated[float, Numeric]], Field(max_length=1000)]
Credit = tuple[Name, ...]
Parents = Annotated[tuple[Digest, ...], Field(max_length=256)]


class CreatureError(InvalidField):
    """A creature file that cannot be accepted: `field`, what it `needed` and what it `got`."""

    def __init__(self, field: str, needed: str, got: object, reason: str = ""):
        reason = reason or f"needs {needed}; got {got!r:.120}"
        super().__init__(field, reason, needed=needed, got=got)
        self.args = field, needed, got, reason


class Measured(Part):
    """Results of an evaluation, and the conditions of its exact repetition."""

    fitness: float
    descriptors: Figures
    measures: Figures
    block: int = Field(ge=1, le=4096)
    room: tuple[Room, Room] | None = None
    """`max_nodes` and `max_connections` of the evaluated arrays; None without a network."""
    device: str = Field(max_length=1000)
    plugins: PluginVersions = Field(default={}, max_length=100)
    """Versions of the plug-ins among the measures."""

    @model_validator(mode="after")
    def refuse_disagreement(self) -> Self:
        pairs = self.descriptors.items()
        if wrong := [name for name, value in pairs if value != self.measures.get(name)]:
            raise InvalidField(
                "measures", f"must hold descriptors; got other values of {wrong}"
            )
        return self


class Provenance(Part):
    """The origin of a creature in a run."""

    parents: Parents
    operator: Label
    generation: int = Field(ge=0, lt=2**53)
    seed: int = Field(ge=0, lt=2**32)
    version: Label


class CreatureFile(Part):
    """The document that people share."""

    identity: Identity
    sha256: Digest
    measured: Measured | None = None
    provenance: Provenance | None = None
    licence: Licence = LICENCE
    credit: Credit = ()
    """Names to show with the creature."""

    @model_validator(mode="after")
    def check(self) -> Self:
        refuse(
            self.provenance and self.sha256 in self.provenance.parents,
            "provenance.parents",
            f"must be other creatures; got its own name {self.sha256}",
        )
        if self.measured is None:
            return self
        room_of(self.identity.genome, self.measured.room)
        expected = fitness_of(self.identity.task, self.measured.measures)
        # Compilers may fuse the sum, which rounds differently.
        refuse(
            not np.isclose(self.measured.fitness, expected, rtol=1e-5, atol=1e-9),
            "measured.fitness",
            f"must be {expected!r} as `measures` have it for "
            f"{self.identity.task.fitness}; got {self.measured.fitness!r}",
        )
        return self


def fitness_of(task: Task, measures: Mapping[str, float]) -> float:
    """Return the fitness in float32, as an evaluation computes it."""
    if task.plugin is not None:
        return measures.get(task.fitness, np.nan)
    if task.fitness in MEASURED:
        name, sign = MEASURED[task.fitness]
        return sign * measures.get(name, np.nan)
    displacement = np.float32(measures.get("displacement", np.nan))
    energy = np.float32(task.energy_weight) * np.float32(measures.get("energy", np.nan))
    both = {"displacement": displacement, "energy": energy}
    return float(both.get(task.fitness, displacement + energy))


def alone(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return a creature file without the files of its ancestors, with which servers send it."""
    return {name: part for name, part in data.items() if name != "ancestors"}


def check(data: Any) -> dict[str, Any]:
    """Return the creature file with its genes, world and hash checked.

    Raises `CreatureError`, which names the field, what was needed and what came.
    """
    try:
        file = CreatureFile.model_validate(data)
    except ValidationError as error:
        errors = error.errors(include_url=False)
        first, given = invalid_fields(errors)[0], errors[0]["input"]
        needed = first.needed or first.reason
        raise CreatureError(first.field or "file", needed, given, first.reason) from error
    document = file.model_dump(mode="json")
    if (expected := name(document["identity"])) != file.sha256:
        raise CreatureError("sha256", f"the hash of the identity, {expected}", file.sha256)
    return document


def scene_of(file: Mapping[str, Any]) -> Scene:
    """Return the scene in which a parsed file is evaluated or replayed."""
    scene = Identity.model_validate(file["identity"]).scene
    measured = file.get("measured") or {}
    plugins = measured.get("plugins") or {}
    named = tuple(name for name in NAMED if name in measured.get("measures", {}))
    if not plugins and not named:
        return scene
    return Scene(**{**dict(scene), "plugins": plugins, "measures": named})


def room_of(genome: Part, recorded: tuple[int, int] | None) -> tuple[int, int] | None:
    """Return the recorded room, or the least that fits: sums round differently in another."""
    if not isinstance(genome, Network):
        return None
    least = (max(8, len(genome.nodes.id)), max(8, len(genome.connections.innovation)))
    nodes, connections = recorded or (least[0], max(least))
    refuse(
        nodes < least[0] or connections < least[1],
        "measured.room",
        f"must be at least {list(least)}, got {[nodes, connections]}",
    )
    return nodes, connections


def room(file: Mapping[str, Any]) -> tuple[int, int] | None:
    """Return `max_nodes` and `max_connections` of a parsed file's network; None without one."""
    parsed = CreatureFile.model_validate(file)
    measured = parsed.measured
    return room_of(parsed.identity.genome, measured.room if measured else None)
