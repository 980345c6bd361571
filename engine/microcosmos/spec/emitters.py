"""Emitters: where the children of a search come from."""

from typing import Annotated, Literal

from pydantic import Field

from .. import plugins
from .base import Part, unit
from .sources import CMA_MAE, CMA_ME, CMA_MEGA, LINE, NEAT, OMG_MEGA, after

Share = Annotated[int, Field(ge=1, le=1000)]
Rate = Annotated[float, Field(ge=0.0, le=1.0)]


class RandomEmitter(Part):
    """New random genomes: a baseline that learns nothing."""

    operator: Literal["random"] = "random"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""


class NeatEmitter(Part):
    """Elites varied by NEAT's mutations, some of them crossed with another elite first."""

    model_config = after(f"{NEAT}, sections 3.1 and 3.2")

    operator: Literal["neat"] = "neat"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""
    crossover: Rate = 0.0
    """Probability that a child has two parents."""


class LineEmitter(Part):
    """An elite, a step of its own, and a step along the line to another elite."""

    model_config = after(LINE)

    operator: Literal["iso+line"] = "iso+line"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""
    iso: float = Field(default=0.02, gt=0.0, le=2.0)
    """Standard deviation of each gene's own step; genes run from −1 to 1."""
    line: float = Field(default=0.2, gt=0.0, le=2.0)
    """Standard deviation of the step along the line, in lengths of the line."""


class GaussianEmitter(Part):
    """An elite and a step of its own."""

    operator: Literal["gaussian"] = "gaussian"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""
    step: float = Field(default=0.1, gt=0.0, le=2.0)
    """Standard deviation of each gene's step; genes run from −1 to 1."""


class CmaMaeEmitter(Part):
    """CMA-MAE: an evolution strategy climbs above thresholds that follow what was found."""

    model_config = after(CMA_MAE)

    operator: Literal["cma-mae"] = "cma-mae"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""
    step: float = Field(default=0.2, gt=0.0, le=2.0)
    """Initial standard deviation of each gene; genes run from −1 to 1."""
    learning_rate: Rate = 0.01
    """How fast a cell's threshold follows the fitness found there, from 0 (CMA-ES) to 1."""
    threshold: float = Field(default=0.0, json_schema_extra=unit("fitness"))
    """Threshold of cells where nothing was found."""


class CmaMeEmitter(Part):
    """CMA-ME's improvement emitters, as QDax has them; the package has to be installed."""

    model_config = after(CMA_ME)

    operator: Literal["cma-me"] = "cma-me"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""
    step: float = Field(default=0.2, gt=0.0, le=2.0)
    """Initial standard deviation of each gene; genes run from −1 to 1."""
    emitters: int = Field(default=1, ge=1, le=64)
    """Emitters that take turns, each with a generation's slots."""


class PopulationEmitter(Part):
    """NEAT with a population of its own: species, sharing, crossover. The archive looks on.

    Values that are left out are those of the preset.
    """

    model_config = after(NEAT)

    operator: Literal["population"] = "population"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""
    preset: Literal["paper", "tensorneat"] = "paper"
    """Settings of Stanley and Miikkulainen (2002) with the mutation rates of `genome`, or the
    defaults of TensorNEAT with its own rates."""
    backend: Literal["microcosmos", "tensorneat"] = "microcosmos"
    """Ours, or TensorNEAT's own program with its defaults, where that package is installed."""
    threshold: float | None = Field(default=None, gt=0.0, le=1e3)
    """Distance within which networks are of one species."""
    target_species: int | None = Field(
        default=None, ge=0, le=1000, json_schema_extra=unit("species")
    )
    """Number of species that the threshold moves towards; 0: it stays."""
    stagnation: int | None = Field(default=None, ge=1, json_schema_extra=unit("generations"))
    """Generations without a better network after which a species has no children."""
    survival: float | None = Field(default=None, gt=0.0, le=1.0)
    """Best share of a species from which parents are drawn."""
    crossover: float | None = Field(default=None, ge=0.0, le=1.0)
    """Probability that a child has two parents."""


class LamarckianEmitter(Part):
    """NEAT's variation; then children learn by gradients, and pass on what they have learnt."""

    model_config = after(OMG_MEGA)

    operator: Literal["lamarckian"] = "lamarckian"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""
    crossover: Rate = 0.0
    """Probability that a child has two parents."""
    lessons: int = Field(default=2, ge=1, le=100)
    """Steps along the slopes of fitness and descriptors; each takes a simulation forwards and
    one backwards for every slope, and counts as an evaluation."""
    step: float = Field(default=0.3, gt=0.0, le=100.0)
    """Length of a step in the space of weights and biases."""
    diversity: float = Field(default=1.0, ge=0.0, le=100.0)
    """Standard deviation of the random weight that each descriptor's slope has beside that of
    fitness, which has 1; 0: fitness alone."""
    segment: int | None = Field(default=None, ge=1, json_schema_extra=unit("steps"))
    """Steps that a gradient keeps in memory at a time, the others done twice; empty: all."""


class CmaMegaEmitter(Part):
    """CMA-MEGA: an evolution strategy over steps along slopes of fitness and descriptors."""

    model_config = after(CMA_MEGA)

    operator: Literal["cma-mega"] = "cma-mega"
    share: Share = 1
    """Its share of the batch, beside the other emitters' shares."""
    step: float = Field(default=0.5, gt=0.0, le=100.0)
    """Initial standard deviation of the weights on unit slopes; genes run from −1 to 1."""
    rate: float = Field(default=1.0, gt=0.0, le=10.0)
    """How far the solution in the middle follows its best children."""
    segment: int | None = Field(default=None, ge=1, json_schema_extra=unit("steps"))
    """Steps that a gradient keeps in memory at a time, the others done twice; empty: all."""


Emitter = Annotated[
    RandomEmitter
    | NeatEmitter
    | PopulationEmitter
    | LineEmitter
    | GaussianEmitter
    | CmaMaeEmitter
    | CmaMeEmitter
    | LamarckianEmitter
    | CmaMegaEmitter,
    Field(discriminator="operator"),
]
"""One source of children."""

OF_NUMBERS = ("iso+line", "gaussian", "cma-mae", "cma-me", "cma-mega")
"""Operators that vary numbers."""

OF_NETWORKS = ("neat", "population", "lamarckian")
"""Operators that vary networks."""

GROWING = ("neat", "lamarckian")
"""Operators that give elites new genes, which they number."""

BY_SLOPES = ("lamarckian", "cma-mega")
"""Operators that need derivatives of every descriptor."""

WITHOUT_SLOPES = ("hidden_nodes", "connections", "nodes", "limited")
"""Measures that have none."""

WITH_NUMBERS = ("direct", "weights")
"""Encodings whose genes are numbers; those of the others are networks."""


def refuse_unfit_emitters(emitters: tuple[Emitter, ...], encoding: str) -> None:
    """Operators must vary what is inherited; TensorNEAT's program works alone."""
    numbers = encoding in WITH_NUMBERS or plugins.is_plugin(encoding)
    unfit = OF_NETWORKS if numbers else OF_NUMBERS
    for emitter in emitters:
        if emitter.operator in unfit:
            fit = OF_NUMBERS if unfit is OF_NETWORKS else OF_NETWORKS
            raise ValueError(
                f"`search.emitters` must be random or of {', '.join(fit)} where "
                f"`control.encoding` is {encoding!r}, got {emitter.operator!r}"
            )
        if getattr(emitter, "backend", None) == "tensorneat" and len(emitters) > 1:
            raise ValueError(
                '`search.emitters` must hold nothing else beside backend "tensorneat", got '
                f"{len(emitters)}"
            )


def gradients(emitter: Emitter, slots: int) -> int:
    """Creatures whose slopes it asks for in a generation."""
    if isinstance(emitter, LamarckianEmitter):
        return emitter.lessons * slots
    return int(isinstance(emitter, CmaMegaEmitter))


def slots(batch: int, shares: tuple[int, ...]) -> tuple[int, ...]:
    """How a batch is divided among shares: whole numbers, the largest remainders rounded up."""
    exact = [batch * share / sum(shares) for share in shares]
    whole = [int(part) for part in exact]
    order = sorted(range(len(shares)), key=lambda i: (whole[i] - exact[i], i))
    for i in order[: batch - sum(whole)]:
        whole[i] += 1
    return tuple(whole)
