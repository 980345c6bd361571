"""The task, the archive and the search of a run."""

from collections.abc import Mapping
from math import prod
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from ..invalid import InvalidField
from ..measures import (
    MEASURES,
    NAMED,
    RECORDED,
    WITHOUT_GRADIENT,
    MeasureName,
    Scale,
    refuse_empty_axis,
)
from .base import (
    BREEDING,
    CVT,
    MAP_ELITES,
    OURS,
    PAPER,
    REEVALUATION,
    SCREENING,
    Digest,
    Part,
    field,
    refuse,
    sourced,
)
from .containers import Container, DominatedNovelty, Fronts, LearnedAxes
from .emitters import STATELESS, VARYING, Emitter, NeatEmitter, emits_of, slots
from .plugins import OR_PLUGIN, MaybePlugin, PluginVersion, complete_plugin, completed


class Reevaluation(Part):
    """Repeated evaluation of elites under disturbed conditions: a test that decides nothing."""

    model_config = sourced(REEVALUATION)

    every: int = field(25, ge=1, le=1_000_000, unit="generations")
    """Interval; elites are also evaluated after the last generation."""
    samples: int = field(4, ge=1, le=100, unit="evaluations")
    """Evaluations per elite each time."""
    phase: bool = True
    """Start a periodic timer at a random phase."""
    pose: bool = True
    """Start the body at a random position and angle."""
    viscosity: float = field(0.05, ge=0.0, le=0.5)
    """Largest relative change of the viscosity."""
    energy: bool = True
    """Move the packets of energy to random places."""


class Breeding(Part):
    """Descent from creatures that people choose while the run goes on.

    From the next generation on a part of each batch descends from the chosen by the run's own
    variation; the rest is as without a choice.
    """

    model_config = sourced(BREEDING, seldom=True)

    share: float = field(0.5, gt=0.0, le=1.0)
    """Share of the first generation's offspring that descend from the chosen."""
    half_life: float = field(10.0, gt=0.0, le=1e6, unit="generations")
    """Generations in which this share halves; older choices also count less beside newer ones
    in this proportion."""


def breeding_refusal(spec: Mapping[str, Any]) -> InvalidField | None:
    """Return why runs of a spec, a document, cannot descend from chosen creatures; None if they
    can."""
    if spec["experiment"] != "quality-diversity":
        return InvalidField(
            "experiment",
            "must be 'quality-diversity' to descend from chosen creatures: others "
            f"draw no parents from an archive, got {spec['experiment']!r}",
        )
    emitters = spec["search"]["emitters"]
    learners = [one["operator"] for one in emitters if emits_of(one).learns != "nothing"]
    if learners:
        return InvalidField(
            "search.emitters",
            f"must be among {', '.join(STATELESS)} to descend from chosen "
            f"creatures, got {learners[0]!r}, which learns from all of its offspring",
        )
    if not any("select" in one for one in emitters):
        return InvalidField(
            "search.emitters",
            f"must contain one of {', '.join(VARYING)} to descend from "
            f"chosen creatures, got only {emitters[0]['operator']!r}, whose parents "
            "cannot be chosen",
        )
    return None


Fitness = Literal[
    "speed",
    "displacement",
    "energy",
    "displacement+energy",
    "cost_of_transport",
    "upstream",
    "through",
]
MEASURED: dict[str, tuple[MeasureName, int]] = {
    "speed": ("speed", 1),
    "cost_of_transport": ("cost_of_transport", -1),
    "upstream": ("advance", -1),
    "through": ("advance", 1),
}
"""Fitness that is a measure, and its sign; the others are displacement and energy."""
STROKED = ("speed", "upstream", "through")
"""Fitness over whole strokes."""


LIGHTEST = 1e-9
"""Least weight of energy: creatures collect up to about 10,000, and what is below 1e-5 cells is
lost beside a displacement of 100 cells in single precision."""


class Task(Part):
    """Duration of a simulation and the fitness of a creature."""

    steps: int = field(2000, ge=10, le=1_000_000, unit="steps")
    """Steps of the simulation."""
    fitness: Annotated[Fitness, *OR_PLUGIN] = field("speed", source=f"displacement: {PAPER}")
    """Fitness: speed (body lengths in 1,000 steps over whole strokes after the first),
    displacement (cells between the mean node positions at start and end), energy collected by
    all nodes, displacement and energy, cost_of_transport (minus the work on the fluid per
    body length: the task of an efficient swimmer), upstream or through (speed along −x against
    the flow of a channel, or along x past obstacles)."""
    trials: int = field(1, ge=1, le=16, unit="simulations")
    """Simulations of each creature, each with 45° more of heading and its share of a stroke
    more of phase; fitness and measures are their means."""
    energy_weight: float = field(1e-3, ge=LIGHTEST, le=1e3, unit="cells/energy")
    """Weight of collected energy relative to displacement."""
    plugin: MaybePlugin = None

    complete = complete_plugin(("fitness",), "fitness")


def _omit_default(schema: dict[str, Any]) -> None:
    """Omit the default, which each measure has of its own."""
    schema.pop("default")


def _end(schema: dict[str, Any]) -> None:
    """Omit the default of an end of an axis and add the units of measures."""
    _omit_default(schema)
    schema["units"] = {name: MEASURES[name].unit for name in (*RECORDED, *NAMED)}
    schema["unit_of"] = "name"


class Descriptor(Part):
    """One axis of the archive."""

    name: Annotated[MeasureName, *OR_PLUGIN]
    """Measure on the axis; it provides the default ends and scale."""
    low: float = Field(default=0.0, ge=-1e30, le=1e30, json_schema_extra=_end)
    """Lower end of the axis; lower values count in the first bin."""
    high: float = Field(default=1.0, ge=-1e30, le=1e30, json_schema_extra=_end)
    """Upper end of the axis; higher values count in the last bin."""
    bins: int = field(20, ge=1, le=1024)
    """Bins along the axis."""
    scale: Scale = Field(default="linear", json_schema_extra=_omit_default)
    """Scale of the axis: bins of equal width in the value, or in its logarithm."""
    plugin: MaybePlugin = None

    @model_validator(mode="before")
    @classmethod
    def complete(cls, given: Any, info: ValidationInfo) -> Any:
        """Fill in the measure's default ends and scale."""
        given, declared = completed(given, ("descriptor",), "name", info)
        known = isinstance(given, dict) and MEASURES.get(str(given.get("name")))
        usual = declared.axis if declared else known
        if not usual:
            return given
        ends = {name: getattr(usual, name) for name in ("low", "high", "scale")}
        return ends | {name: value for name, value in given.items() if value is not None}

    @model_validator(mode="after")
    def refuse_empty(self) -> Self:
        refuse_empty_axis(self.low, self.high, self.scale, self.bins)
        return self


MAX_CELLS = 2**20
"""Most cells of an archive."""


class Archive(Part):
    """An archive over one to eight descriptors, with one elite per cell by default."""

    model_config = sourced(MAP_ELITES)

    descriptors: Annotated[tuple[Descriptor, ...], Field(min_length=1, max_length=8)] = (
        Descriptor(name="symmetry"),
        Descriptor(name="curvature_mean"),
    )
    """Axes of the archive."""
    centroids: int | None = field(None, ge=2, le=MAX_CELLS, source=CVT)
    """Number of cells of a centroidal Voronoi tessellation, which replaces the bins; empty: a
    grid of bins."""
    seed: int = field(0, ge=0, lt=2**32)
    """Random seed of the tessellation."""
    container: Container | None = None
    """Container that replaces one elite per cell; empty: one elite per cell."""

    @property
    def plugins(self) -> dict[str, PluginVersion]:
        """Return the versions of the plug-ins among the descriptors, by name."""
        return {axis.name: axis.plugin for axis in self.descriptors if axis.plugin}

    @property
    def named(self) -> tuple[str, ...]:
        """Return the built-in measures that are recorded because the archive names them."""
        container = self.container
        names = {axis.name for axis in self.descriptors}
        names |= {getattr(container, "measure", None), *getattr(container, "measures", ())}
        return tuple(name for name in NAMED if name in names)

    @property
    def shape(self) -> tuple[int, ...]:
        if self.centroids is not None:
            return (self.centroids,)
        return tuple(d.bins for d in self.descriptors)

    @property
    def cells(self) -> int:
        return prod(self.shape)

    @property
    def places(self) -> int:
        """Return the largest number of elites."""
        match self.container:
            case Fronts(size=size):
                return size * self.cells
            case DominatedNovelty(size=size):
                return size
            case LearnedAxes(axes=axes, bins=bins):
                return bins**axes
        return self.cells

    @model_validator(mode="after")
    def refuse_impossible(self) -> Self:
        names = [d.name for d in self.descriptors]
        refuse(len(set(names)) < len(names), "descriptors", f"must not repeat, got {names}")
        if self.cells > MAX_CELLS:
            product = " × ".join(map(str, self.shape))
            raise InvalidField(
                "descriptors",
                f"must make at most {MAX_CELLS:,} cells, got {product} = "
                f"{self.cells:,}: reduce `bins` or set `centroids`",
            )
        refuse(
            self.places > MAX_CELLS,
            "container",
            f"must have at most {MAX_CELLS:,} places, got {self.places:,}",
        )
        return self


def refuse_flat_axes(archive: Archive, purpose: str) -> None:
    """Raise `ValueError` where a descriptor has no derivative."""
    flat = [axis.name for axis in archive.descriptors if axis.name in WITHOUT_GRADIENT]
    if flat:
        raise InvalidField(
            "archive.descriptors", f"must have derivatives for {purpose}, got {flat[0]!r}"
        )


class Stop(Part):
    """Conditions that end a run after the generation that meets one; empty: none."""

    evaluations: int | None = field(None, ge=1, unit="evaluations")
    """Maximum number of evaluations."""
    device_hours: float | None = field(None, gt=0.0, unit="hours")
    """Maximum time of evaluation, summed over devices. The decision is recorded, but another
    run of the spec may end at another generation."""
    fitness: float | None = field(None, ge=-1e30, le=1e30, unit="fitness")
    """Target fitness."""


class Screening(Part):
    """Prediction of many offspring, of which the most promising are simulated.

    A stroke in resistive force theory describes each one. A model that learns from the run's
    own simulations predicts fitness, cell and whether it is feasible.
    """

    model_config = sourced(SCREENING)

    # QD score after 6,400 simulations of `standard`, one seed: 118 with one round of 10
    # candidates, 130 to 135 with one of 40, 136 to 149 with four of 40 (docs/evolution.md).
    rounds: int = field(4, ge=1, le=100, unit="rounds")
    """Rounds of candidates; those of a later round descend also from the best predicted."""
    candidates: int = field(40, ge=1, le=1000, unit="candidates")
    """Candidates in a round for each offspring that is simulated."""
    unscreened: float = field(0.1, ge=0.0, le=1.0)
    """Share of the offspring that is simulated whatever the prediction."""


MAX_INITIAL = 4096
"""Most initial creatures of a search."""


def _in_order(names: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(sorted(set(names)))


InitialCreatures = Annotated[
    tuple[Digest, ...], Field(max_length=MAX_INITIAL), AfterValidator(_in_order)
]


class Generations(Part):
    """Number and size of generations, and when to stop."""

    generations: int = field(50, ge=1, le=1_000_000, unit="generations")
    """Number of generations, the first random one included."""
    batch: int = field(64, ge=1, le=65_536, unit="creatures")
    """Evaluations per generation."""
    # On a CPU a device works off its block one by one; a batch on a GPU needs more.
    block: int = field(16, ge=1, le=4096, unit="creatures")
    """Creatures per call of the compiled program; the exact bits of results depend on it. A GPU
    needs 256 or more to be busy."""
    feasible: bool = field(True, source=OURS)
    """Refuse creatures at a limit in more than 0.1 % of node steps, with a Mach number above
    0.17 anywhere, with a net impulse on the fluid above 1e-4, or whose filaments cross."""
    stop: Stop = Stop()
    """Conditions that end the run early."""
    reevaluation: Reevaluation | None = None
    """Repeated evaluation of elites; empty: none."""
    initial: InitialCreatures = ()
    """Initial creatures (SHA-256), in place of random ones."""


class Search(Generations):
    """MAP-Elites: generations of offspring of elites."""

    model_config = sourced(MAP_ELITES)

    emitters: Annotated[tuple[Emitter, ...], Field(min_length=1, max_length=16)] = (
        NeatEmitter(),
    )
    """Sources of offspring."""
    screening: Screening | None = None
    """Prediction of offspring before they are simulated; empty: none."""
    breeding: Breeding = Breeding()
    """Descent from creatures that people choose while the run goes on."""

    @property
    def slots(self) -> tuple[int, ...]:
        """Return the offspring per generation of each emitter."""
        return slots(self.batch, tuple(emitter.share for emitter in self.emitters))

    @model_validator(mode="after")
    def check(self) -> Self:
        if 0 in self.slots:
            idle = self.emitters[self.slots.index(0)].operator
            raise InvalidField(
                "batch",
                f"must be large enough for each of the `emitters`, got {self.batch}, "
                f"which leaves none for {idle!r}",
            )
        for emitter, count in zip(self.emitters, self.slots, strict=True):
            emitter.refuse_slots(count)
        learners = [one.operator for one in self.emitters if one.emits.learns != "nothing"]
        if learners and self.screening:
            raise InvalidField(
                "emitters",
                f"must be among {', '.join(STATELESS)} with `screening`, got "
                f"{learners[0]!r}, which learns from all of its offspring",
            )
        return self
