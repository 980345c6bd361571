"""The task, the archive and the search that fills it."""

from math import prod
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from . import measures
from .base import Part, unit
from .emitters import BY_SLOPES, GROWING, WITHOUT_SLOPES, Emitter, NeatEmitter, slots
from .plugins import OR_PLUGIN, MaybePlugin, PluginVersion, complete_plugin, completed
from .sources import CVT, MAP_ELITES, PAPER, REEVALUATION, after, source

Fitness = Literal["displacement", "energy", "displacement+energy"]


class Task(Part):
    """How long a creature is simulated, and what its fitness is."""

    steps: int = Field(default=500, ge=10, le=1_000_000, json_schema_extra=unit("steps"))
    """Steps of the simulation."""
    fitness: Annotated[Fitness, *OR_PLUGIN] = Field(
        default="displacement", json_schema_extra=source(PAPER)
    )
    """Distance between the mean unwrapped node position at the end and at the start; energy
    that all nodes collect; or both."""
    energy_weight: float = Field(
        default=1e-3, gt=0.0, le=1e3, json_schema_extra=unit("cells/energy")
    )
    """What a unit of collected energy is worth beside a cell of displacement."""
    plugin: MaybePlugin = None

    complete = complete_plugin(("fitness",), "fitness")


def _by_name(schema: dict[str, Any]) -> None:
    """The default is another for each measure."""
    schema.pop("default")


def _end(schema: dict[str, Any]) -> None:
    """An end of an axis; the unit too is the measure's."""
    _by_name(schema)
    schema["units"] = {name: one.unit for name, one in measures.MEASURES.items()}
    schema["unit_of"] = "name"


class Descriptor(Part):
    """One axis of the archive."""

    name: Annotated[measures.Name, *OR_PLUGIN]
    """What is measured; ends and scale are the measure's own unless they are given."""
    low: float = Field(default=0.0, ge=-1e30, le=1e30, json_schema_extra=_end)
    """Lower end of the axis, in raw units; what is below counts in the first bin."""
    high: float = Field(default=1.0, ge=-1e30, le=1e30, json_schema_extra=_end)
    """Upper end of the axis, in raw units; what is above counts in the last bin."""
    bins: int = Field(default=20, ge=1, le=1024)
    """Cells along the axis."""
    scale: measures.Scale = Field(default="linear", json_schema_extra=_by_name)
    """Whether bins are equally wide in the logarithm or in the raw value."""
    plugin: MaybePlugin = None

    @model_validator(mode="before")
    @classmethod
    def complete(cls, given: Any, info: ValidationInfo) -> Any:
        """What is left out is the measure's own."""
        given, declared = completed(given, ("descriptor",), "name", info)
        known = isinstance(given, dict) and measures.MEASURES.get(str(given.get("name")))
        usual = declared.axis if declared else known
        if not usual:
            return given
        ends = {name: getattr(usual, name) for name in ("low", "high", "scale")}
        return ends | {name: value for name, value in given.items() if value is not None}

    @model_validator(mode="after")
    def refuse_empty(self) -> Self:
        if self.high <= self.low:
            raise ValueError(f"`high` must be above `low` ({self.low:g}), got {self.high:g}")
        if self.scale == "log10" and self.low <= 0:
            raise ValueError(f"`low` must be above 0 where `scale` is log10, got {self.low:g}")
        return self


CELLS = 2**20
"""The most that an archive may have."""


class Archive(Part):
    """Cells over one to eight descriptors, one elite in each."""

    model_config = after(MAP_ELITES)

    descriptors: Annotated[tuple[Descriptor, ...], Field(min_length=1, max_length=8)] = (
        Descriptor(name="bending_effort"),
        Descriptor(name="stretching_effort"),
    )
    """Axes of the archive: what tells its kinds of creatures apart."""
    centroids: int | None = Field(default=None, ge=2, le=CELLS, json_schema_extra=source(CVT))
    """Cells of a centroidal Voronoi tessellation, equally large on the descriptors' own scales
    and in place of their bins; none: the bins make a grid."""
    seed: int = Field(default=0, ge=0, lt=2**32)
    """Which of many tessellations that is."""

    @property
    def plugins(self) -> dict[str, PluginVersion]:
        """Versions of the plug-ins among the descriptors, by name."""
        return {axis.name: axis.plugin for axis in self.descriptors if axis.plugin}

    @property
    def shape(self) -> tuple[int, ...]:
        if self.centroids is not None:
            return (self.centroids,)
        return tuple(d.bins for d in self.descriptors)

    @property
    def cells(self) -> int:
        return prod(self.shape)

    @model_validator(mode="after")
    def refuse_repeated(self) -> Self:
        names = [d.name for d in self.descriptors]
        if len(set(names)) < len(names):
            raise ValueError(f"`descriptors` must differ, got {names}")
        return self

    @model_validator(mode="after")
    def refuse_too_many(self) -> Self:
        if self.cells > CELLS:
            product = " × ".join(map(str, self.shape))
            raise ValueError(
                f"`descriptors` must make at most {CELLS:,} cells, all of which are kept in "
                f"memory with their genomes; got {product} = {self.cells:,} (`centroids` gives "
                "any number of cells over many descriptors)"
            )
        return self


def refuse_flat(archive: Archive, emitters: tuple[Emitter, ...]) -> None:
    """What learns by gradients needs descriptors that have one."""
    for emitter in emitters:
        if emitter.operator in BY_SLOPES:
            refuse_flat_axes(archive, emitter.operator)


def refuse_flat_axes(archive: Archive, purpose: str) -> None:
    """Descriptors must have derivatives."""
    flat = [axis.name for axis in archive.descriptors if axis.name in WITHOUT_SLOPES]
    if flat:
        raise ValueError(
            f"`archive.descriptors` must have derivatives for {purpose}, got {flat[0]!r}"
        )


class Stop(Part):
    """When a run ends before its generations are through; each may be left out."""

    evaluations: int | None = Field(default=None, ge=1, json_schema_extra=unit("evaluations"))
    """After the generation in which so many creatures have been evaluated."""
    device_hours: float | None = Field(default=None, gt=0.0, json_schema_extra=unit("hours"))
    """After the generation in which evaluation has taken so long, all devices added up. What
    was decided is recorded, but another run may end at another generation."""
    fitness: float | None = Field(default=None, json_schema_extra=unit("fitness"))
    """After the generation in which a creature was at least so fit."""


class Reevaluation(Part):
    """Elites evaluated again under disturbed conditions, to see how much of them was luck."""

    model_config = after(REEVALUATION)

    every: int = Field(default=25, ge=1, le=1_000_000, json_schema_extra=unit("generations"))
    """After every so many generations, and after the last."""
    samples: int = Field(default=1, ge=1, le=100, json_schema_extra=unit("evaluations"))
    """Evaluations of each elite each time."""
    phase: bool = True
    """Whether a periodic timer starts anywhere in its period."""
    pose: bool = True
    """Whether the body starts anywhere, turned by any angle."""
    viscosity: float = Field(default=0.05, ge=0.0, le=0.5)
    """Up to which share of itself the viscosity changes."""
    energy: bool = True
    """Whether the packets of energy are moved, where there are any."""


MAX_INITIAL = 4096
"""The most creatures that a search may begin from."""


def _in_order(names: tuple[str, ...]) -> tuple[str, ...]:
    """Each once, in one order, so that the order in which they were named changes nothing."""
    return tuple(sorted(set(names)))


Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]

InitialCreatures = Annotated[
    tuple[Digest, ...], Field(max_length=MAX_INITIAL), AfterValidator(_in_order)
]


class Generations(Part):
    """Generations of equal size, and when they end."""

    generations: int = Field(
        default=50, ge=1, le=1_000_000, json_schema_extra=unit("generations")
    )
    """Generations of the run, the random first one among them."""
    batch: int = Field(default=64, ge=1, le=65_536, json_schema_extra=unit("creatures"))
    """Creatures evaluated in a generation."""
    block: int = Field(default=16, ge=1, le=4096, json_schema_extra=unit("creatures"))
    """Creatures evaluated by one call of the compiled program; results depend on its bits."""
    stop: Stop = Stop()
    """When to end before the generations are through."""
    reevaluation: Reevaluation | None = None
    """How elites are evaluated again; none: they are not."""
    initial: InitialCreatures = ()
    """Names (SHA-256) of creatures that the search begins from, in place of random ones."""


class Search(Generations):
    """MAP-Elites: children of elites in generations of equal size."""

    model_config = after(MAP_ELITES)

    emitters: Annotated[tuple[Emitter, ...], Field(min_length=1, max_length=16)] = (
        NeatEmitter(),
    )
    """Where children come from."""

    @property
    def slots(self) -> tuple[int, ...]:
        """Children of each emitter in a generation."""
        return slots(self.batch, tuple(emitter.share for emitter in self.emitters))

    @model_validator(mode="after")
    def refuse_idle(self) -> Self:
        if 0 in self.slots:
            idle = self.emitters[self.slots.index(0)].operator
            raise ValueError(
                f"`batch` must leave a creature for each of the `emitters`, got "
                f"{self.batch}, none of them for {idle!r}"
            )
        growing = [one.operator for one in self.emitters if one.operator in GROWING]
        if len(growing) > 1:
            raise ValueError(
                f"`emitters` must hold one of {' and '.join(GROWING)} at most, so that equal "
                f"mutations of a generation get equal numbers; got {', '.join(growing)}"
            )
        return self
