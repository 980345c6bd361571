"""The creature file: its model, and checks of its contents."""

import re
from collections.abc import Mapping
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, StringConstraints, ValidationError, model_validator

from ...naming import LICENCE, name
from ..base import Digest, Part, field_path
from ..plugins import PluginVersions
from ..scene import Scene
from ..search import MEASURED, Task
from .genomes import Network
from .identity import Identity

Room = Annotated[int, Field(ge=8, le=8192)]
Name = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=200)]
Label = Annotated[str, StringConstraints(max_length=200)]
Figures = Annotated[dict[Label, float], Field(max_length=1000)]
Credit = Annotated[tuple[Name, ...], Field(max_length=50)]
Parents = Annotated[tuple[Digest, ...], Field(max_length=256)]


class CreatureError(ValueError):
    """A creature file that cannot be accepted: `field`, what it `needed` and what it `got`."""

    def __init__(self, field: str, needed: str, got: object):
        super().__init__(f"`{field}` needs {needed}; got {got!r:.120}")
        self.field, self.needed, self.got = field, needed, got


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
            raise ValueError(f"`measures` must hold descriptors; got other values of {wrong}")
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
    licence: Name = LICENCE
    credit: Credit = ()
    """Names to show with the creature."""

    @model_validator(mode="after")
    def refuse_its_own_parent(self) -> Self:
        if self.provenance and self.sha256 in self.provenance.parents:
            raise ValueError(
                f"`provenance.parents` must be other creatures; got its own name {self.sha256}"
            )
        return self

    @model_validator(mode="after")
    def refuse_other_measures(self) -> Self:
        if self.measured is None:
            return self
        room_of(self.identity.genome, self.measured.room)
        expected = fitness_of(self.identity.task, self.measured.measures)
        # Compilers may fuse the sum, which rounds differently.
        if not np.isclose(self.measured.fitness, expected, rtol=1e-5, atol=1e-9):
            raise ValueError(
                f"`measured.fitness` must be {expected!r} as `measures` have it for "
                f"{self.identity.task.fitness}; got {self.measured.fitness!r}"
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


def check(data: Any) -> dict[str, Any]:
    """Return the creature file with its genes, world and hash checked.

    Raises `CreatureError`, which names the field, what was needed and what came.
    """
    try:
        file = CreatureFile.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        needed = first["msg"].removeprefix("Value error, ")
        named = re.match(r"`([\w.]+)`", needed)
        field = field_path(first["loc"]) or (named[1] if named else "file")
        raise CreatureError(field, needed, first["input"]) from error
    document = file.model_dump(mode="json")
    if (expected := name(document["identity"])) != file.sha256:
        raise CreatureError("sha256", f"the hash of the identity, {expected}", file.sha256)
    return document


def scene_of(file: Mapping[str, Any]) -> Scene:
    """Return the scene in which a parsed file is evaluated or replayed."""
    scene = Identity.model_validate(file["identity"]).scene
    plugins = (file.get("measured") or {}).get("plugins")
    return Scene(**{**dict(scene), "plugins": plugins}) if plugins else scene


def room_of(genome: Part, recorded: tuple[int, int] | None) -> tuple[int, int] | None:
    """Return the recorded room, or the least that fits: sums round differently in another."""
    if not isinstance(genome, Network):
        return None
    least = (max(8, len(genome.nodes.id)), max(8, len(genome.connections.innovation)))
    nodes, connections = recorded or (least[0], max(least))
    if nodes < least[0] or connections < least[1]:
        raise ValueError(
            f"`measured.room` must be at least {list(least)}, got {[nodes, connections]}"
        )
    return nodes, connections


def room(file: Mapping[str, Any]) -> tuple[int, int] | None:
    """Return `max_nodes` and `max_connections` of a parsed file's network; None without one."""
    parsed = CreatureFile.model_validate(file)
    measured = parsed.measured
    return room_of(parsed.identity.genome, measured.room if measured else None)
