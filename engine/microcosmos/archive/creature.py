"""Creature files: what a creature is, named by the SHA-256 of its canonical form."""

import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from ..spec import (
    OUTPUTS,
    Body,
    Control,
    Coupling,
    Genome,
    QualityDiversity,
    Search,
    Task,
    World,
)
from ..spec.base import Part
from .cppn_genes import Connections, Nodes, check_genes
from .naming import FORMAT, LICENCE, canonical, name

__all__ = ["FORMAT", "CreatureError", "canonical", "document", "name", "parse", "spec_of"]


Room = Annotated[int, Field(ge=8, le=8192)]
Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class CreatureError(ValueError):
    """A creature file that cannot be accepted: `field`, what it `needed` and what it `got`."""

    def __init__(self, field: str, needed: str, got: object):
        super().__init__(f"`{field}` needs {needed}; got {got!r:.120}")
        self.field, self.needed, self.got = field, needed, got


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


class PlacedWorld(World):
    """The world with the form of the coupling, both of which a creature's numbers depend on."""

    coupling: Coupling


class Identity(Part):
    """Everything that a creature is."""

    format: Literal["microcosmos-creature/1"]
    genome: CPPN
    world: PlacedWorld
    body: Body
    task: Task

    @model_validator(mode="after")
    def check_fit(self) -> Self:
        _spec(self)
        return self


class Measured(Part):
    """What was found when the creature was evaluated, and what repeating it exactly needs."""

    fitness: float
    descriptors: dict[str, float]
    features: dict[str, float]
    block: int = Field(ge=1, le=4096)
    room: tuple[Room, Room]
    """`max_nodes` and `max_connections` of the evaluated arrays."""
    device: str

    @model_validator(mode="after")
    def check_agreement(self) -> Self:
        """Fitness and descriptors are features, so that a check of those is one of all."""
        told = {**self.descriptors, "displacement": self.fitness}
        if wrong := [name for name in told if told[name] != self.features.get(name)]:
            raise ValueError(
                f"`features` must hold fitness (as displacement) and descriptors; "
                f"got other values of {wrong}"
            )
        return self


class Provenance(Part):
    """Where the creature came from."""

    parents: tuple[Digest, ...]
    operator: str
    generation: int = Field(ge=0)
    seed: int = Field(ge=0)
    version: str


class CreatureFile(Part):
    """The whole document that people share."""

    identity: Identity
    sha256: Digest
    measured: Measured | None = None
    provenance: Provenance | None = None
    licence: str = LICENCE

    @model_validator(mode="after")
    def check_room(self) -> Self:
        """The arrays that were measured had room for the genes."""
        _spec(self.identity, self.measured)
        return self


def document(
    identity: Mapping[str, Any],
    measured: Mapping[str, Any] | None,
    provenance: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """The creature file around an identity."""
    return {
        "identity": dict(identity),
        "sha256": name(identity),
        "measured": dict(measured) if measured else None,
        "provenance": dict(provenance) if provenance else None,
        "licence": LICENCE,
    }


def parse(data: Any) -> dict[str, Any]:
    """A creature file from anybody, checked: its genes, its world and its hash.

    Raises `CreatureError`, which names the field, what was needed and what came.
    """
    if isinstance(data, str | bytes):
        try:
            data = json.loads(data)
        except (ValueError, RecursionError) as error:
            raise CreatureError("file", f"JSON ({error})", data[:60]) from error
    try:
        file = CreatureFile.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"]) or "file"
        needed = first["msg"].removeprefix("Value error, ")
        raise CreatureError(field, needed, first["input"]) from error
    whole = file.model_dump(mode="json")
    expected = name(whole["identity"])
    if expected != file.sha256:
        raise CreatureError("sha256", f"the identity's own hash {expected}", file.sha256)
    return whole


def spec_of(file: Mapping[str, Any]) -> QualityDiversity:
    """The spec under which one creature of a parsed file is evaluated or replayed."""
    parsed = CreatureFile.model_validate(file)
    return _spec(parsed.identity, parsed.measured)


def _spec(identity: Identity, measured: Measured | None = None) -> QualityDiversity:
    """The room is the recorded one, else just enough: sums round differently in another."""
    genome = identity.genome
    least = (max(8, len(genome.nodes.id)), max(8, len(genome.connections.innovation)))
    nodes, connections = measured.room if measured else (least[0], max(least))
    if nodes < least[0] or connections < least[1]:
        raise ValueError(f"`room` must be at least {list(least)}, got {[nodes, connections]}")
    world = identity.world.model_dump()
    coupling = world.pop("coupling")
    return QualityDiversity(
        world=World(**world),
        coupling=Coupling(**coupling),
        body=identity.body,
        control=genome.control,
        genome=Genome(max_nodes=nodes, max_connections=connections),
        task=identity.task,
        search=Search(batch=1, block=measured.block if measured else 1, generations=1),
    )
