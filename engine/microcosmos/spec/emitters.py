"""Emitters: the sources of offspring in a search."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, Tag
from pydantic.json_schema import SkipJsonSchema

from ..invalid import InvalidField
from ..plugins import Emits, is_plugin
from .base import (
    CMA_MAE,
    CMA_ME,
    CMA_MEGA,
    CURIOSITY,
    LINE,
    NEAT,
    PERCEPTIBLE,
    TOURNAMENT,
    Part,
    field,
    name_in,
    one_of,
    refuse,
    sourced,
)
from .plugins import PluginName, PluginVersion, complete_plugin

Rate = Annotated[float, Field(ge=0.0, le=1.0)]


class WeightedEmitter(Part):
    """An emitter beside others."""

    operator: str
    share: int = field(1, ge=1, le=1000)
    """Weight of this emitter when the batch is divided among all emitters."""

    facts: ClassVar[Emits]
    """Facts about every emitter of the class."""

    @property
    def emits(self) -> Emits:
        """Return facts about the emitter: genomes, source of learning, gradients."""
        return self.facts

    @property
    def is_portable(self) -> bool:
        """Return whether it computes the same bits on every processor."""
        # XLA's programs for derivatives round as a processor likes, see docs/physics.md.
        return not self.emits.gradients

    def refuse_slots(self, slots: int) -> None:
        """Raise `ValueError` where it cannot make this number of offspring in a generation."""


class SelectingEmitter(WeightedEmitter):
    """An emitter that draws its parents from the archive."""

    # Half of the parents by tournament: with stronger selection the fittest are faster and the
    # kinds of motion fewer (docs/evolution.md, "Encodings").
    select: Literal["uniform", "mixed", "tournament", "curiosity"] = field(
        "mixed", source=f"{TOURNAMENT}; {CURIOSITY}"
    )
    """Selection of parents: every elite with equal probability (uniform), the fittest of three
    such draws (tournament), half of the parents each way (mixed), or mixed and more often those
    whose children have entered (curiosity)."""


class RandomEmitter(WeightedEmitter):
    """New random genomes: a baseline that learns nothing."""

    facts: ClassVar[Emits] = Emits(varies=("networks", "numbers"))

    operator: Literal["random"] = "random"


class NeatEmitter(SelectingEmitter):
    """Elites varied by NEAT's mutations, some crossed with another elite first."""

    model_config = sourced(f"{NEAT}, sections 3.1 and 3.2")
    facts: ClassVar[Emits] = Emits(varies=("networks",))

    operator: Literal["neat"] = "neat"
    crossover: Rate = 0.0
    """Probability of crossover with a second parent."""


class LineEmitter(SelectingEmitter):
    """An elite plus an isotropic step and a step along the line to another elite."""

    model_config = sourced(LINE)
    facts: ClassVar[Emits] = Emits(varies=("numbers",))

    operator: Literal["iso+line"] = "iso+line"
    # 1.8 times the QD score of 0.02 (docs/evolution.md, "Steps of iso+line").
    iso: float = field(0.1, ge=PERCEPTIBLE, le=2.0)
    """Standard deviation of the isotropic step; genes lie within ±1."""
    line: float = field(0.2, ge=PERCEPTIBLE, le=2.0)
    """Standard deviation of the step along the line, relative to the line's length."""


class GaussianEmitter(SelectingEmitter):
    """An elite plus an isotropic step."""

    facts: ClassVar[Emits] = Emits(varies=("numbers",))

    operator: Literal["gaussian"] = "gaussian"
    step: float = field(0.1, ge=PERCEPTIBLE, le=2.0)
    """Standard deviation of the step; genes lie within ±1."""


class CmaMeEmitter(WeightedEmitter):
    """CMA-ME's improvement emitters of QDax, which must be installed."""

    model_config = sourced(CMA_ME)
    facts: ClassVar[Emits] = Emits(varies=("numbers",), learns="cells")

    operator: Literal["cma-me"] = "cma-me"
    step: float = field(0.2, ge=PERCEPTIBLE, le=2.0)
    """Initial standard deviation; genes lie within ±1."""
    emitters: int = field(1, ge=1, le=64)
    """Emitters that take turns, one per generation."""

    @property
    def is_portable(self) -> bool:
        return False  # QDax decomposes matrices by a library of linear algebra.


class CmaMaeEmitter(WeightedEmitter):
    """CMA-MAE: evolution strategies that improve on thresholds, which follow the archive."""

    model_config = sourced(CMA_MAE)
    facts: ClassVar[Emits] = Emits(varies=("numbers",), learns="cells")

    operator: Literal["cma-mae"] = "cma-mae"
    step: float = field(0.2, ge=PERCEPTIBLE, le=2.0)
    """Initial standard deviation; genes lie within ±1."""
    learning_rate: Rate = 0.01
    """Rate at which a cell's threshold follows the fitness found there; 0: CMA-ES."""
    threshold: float = field(0.0, ge=-1e30, le=1e30, unit="fitness")
    """Threshold of empty cells."""
    emitters: int = field(1, ge=1, le=64)
    """Strategies that share the thresholds, each with an equal part of the offspring."""

    def refuse_slots(self, slots: int) -> None:
        refuse(
            slots % self.emitters,
            "emitters",
            f"must divide its {slots} offspring of a generation evenly, got "
            f"{self.emitters}. Change `emitters` or `batch`",
        )


class PopulationEmitter(WeightedEmitter):
    """NEAT with its own population (species, fitness sharing, crossover) beside the archive.

    Empty values are those of the preset.
    """

    model_config = sourced(NEAT)
    facts: ClassVar[Emits] = Emits(varies=("networks",), learns="offspring")

    operator: Literal["population"] = "population"
    preset: Literal["paper", "tensorneat"] = "paper"
    """Settings of Stanley and Miikkulainen (2002) with the mutation rates of `genome`, or the
    defaults of TensorNEAT with its own rates."""
    threshold: float | None = field(None, gt=0.0, le=1e3)
    """Compatibility distance within which networks belong to one species."""
    stagnation: int | None = field(None, ge=1, unit="generations")
    """Generations without improvement after which a species has no offspring."""
    survival: float | None = field(None, gt=0.0, le=1.0)
    """Fittest share of a species from which parents are drawn."""
    crossover: float | None = field(None, ge=0.0, le=1.0)
    """Probability of crossover with a second parent."""


class CmaMegaEmitter(WeightedEmitter):
    """CMA-MEGA: an evolution strategy over gradient steps of fitness and descriptors."""

    model_config = sourced(CMA_MEGA)
    facts: ClassVar[Emits] = Emits(varies=("numbers",), learns="cells", gradients=1)

    operator: Literal["cma-mega"] = "cma-mega"
    step: float = field(0.5, ge=PERCEPTIBLE, le=100.0)
    """Initial standard deviation of the weights of unit gradients; genes lie within ±1."""
    rate: float = field(1.0, ge=PERCEPTIBLE, le=10.0)
    """Learning rate of the mean solution towards its best offspring."""
    segment: int | None = field(None, ge=1, unit="steps")
    """Steps that a gradient keeps in memory at a time, recomputing the others; empty: all."""


class PluginEmitter(WeightedEmitter):
    """An emitter that a plug-in builds."""

    operator: PluginName
    plugin: PluginVersion

    complete = complete_plugin(("emitter",), "operator")

    @property
    def emits(self) -> Emits:
        assert self.plugin.emits is not None  # Its declaration has them.
        return self.plugin.emits

    @property
    def is_portable(self) -> bool:
        return False  # A module may sum as a processor likes.


BUILT_IN: dict[str, WeightedEmitter] = {
    one.operator: one
    for one in (
        RandomEmitter(),
        NeatEmitter(),
        LineEmitter(),
        GaussianEmitter(),
        CmaMeEmitter(),
        CmaMaeEmitter(),
        PopulationEmitter(),
        CmaMegaEmitter(),
    )
}
"""The built-in emitters with their defaults, by name."""

Emitter = Annotated[
    Annotated[RandomEmitter, Tag("random")]
    | Annotated[NeatEmitter, Tag("neat")]
    | Annotated[LineEmitter, Tag("iso+line")]
    | Annotated[GaussianEmitter, Tag("gaussian")]
    | Annotated[CmaMeEmitter, Tag("cma-me")]
    | Annotated[CmaMaeEmitter, Tag("cma-mae")]
    | Annotated[PopulationEmitter, Tag("population")]
    | Annotated[CmaMegaEmitter, Tag("cma-mega")]
    | Annotated[SkipJsonSchema[PluginEmitter], Tag("plugin")],
    *one_of("operator", tuple(BUILT_IN), name_in("operator")),
]
"""One source of offspring."""

STATELESS = tuple(name for name, one in BUILT_IN.items() if one.emits.learns == "nothing")
"""Emitters that learn nothing from the outcome, so that any of their offspring, and any number
of them, may be evaluated."""

VARYING = tuple(name for name, one in BUILT_IN.items() if isinstance(one, SelectingEmitter))
"""Emitters that vary any parents."""

UNKNOWN = Emits(varies=("networks", "numbers"), learns="cells")
"""Facts about an emitter of another version."""


def emits_of(emitter: Mapping[str, Any]) -> Emits:
    """Return the facts about an emitter in a complete document."""
    name = emitter["operator"]
    if is_plugin(name):
        return Emits(**emitter["plugin"]["emits"])
    # A run of another version may name an emitter that this one does not have.
    return BUILT_IN[name].emits if name in BUILT_IN else UNKNOWN


def refuse_unfit_emitters(emitters: Sequence[WeightedEmitter], encoding: str) -> None:
    """Raise `ValueError` where an emitter cannot vary an encoding's genomes."""
    genes = "numbers" if encoding == "direct" or is_plugin(encoding) else "networks"
    for emitter in emitters:
        if genes not in emitter.emits.varies:
            fit = [name for name, one in BUILT_IN.items() if genes in one.emits.varies]
            raise InvalidField(
                "search.emitters",
                f"must be among {', '.join(fit)} where `control.encoding` is {encoding!r}, "
                f"got {emitter.operator!r}",
            )


def refuse_initial(emitters: Sequence[WeightedEmitter], initial: int, batch: int) -> None:
    """Raise `ValueError` where a population cannot begin with a number of creatures."""
    if not initial or not any(isinstance(one, PopulationEmitter) for one in emitters):
        return
    refuse(
        len(emitters) > 1,
        "search.initial",
        f"must be empty for a population beside other emitters, got {initial} creatures",
    )
    refuse(
        initial > batch,
        "search.initial",
        f"must have at most `search.batch` ({batch}) creatures for a population, got {initial}",
    )


def slots(batch: int, shares: tuple[int, ...]) -> tuple[int, ...]:
    """Divide a batch among shares in whole numbers; the largest remainders round up."""
    exact = [batch * share / sum(shares) for share in shares]
    whole = [int(part) for part in exact]
    order = sorted(range(len(shares)), key=lambda i: (whole[i] - exact[i], i))
    for i in order[: batch - sum(whole)]:
        whole[i] += 1
    return tuple(whole)
