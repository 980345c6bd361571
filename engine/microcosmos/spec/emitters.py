"""Emitters: the sources of offspring in a search."""

from typing import Annotated, Literal

from pydantic import Field

from .. import plugins
from .base import NETWORK_OPERATORS, VECTOR_OPERATORS, Part, field, sourced
from .sources import CMA_MAE, CMA_ME, CMA_MEGA, CURIOSITY, LINE, NEAT, OMG_MEGA, TOURNAMENT

Rate = Annotated[float, Field(ge=0.0, le=1.0)]


class WeightedEmitter(Part):
    """An emitter beside others."""

    share: int = field(1, ge=1, le=1000)
    """Weight of this emitter when the batch is divided among all emitters."""


class SelectingEmitter(WeightedEmitter):
    """An emitter that draws its parents from the archive."""

    select: Literal["uniform", "mixed", "tournament", "curiosity"] = field(
        "mixed", source=f"{TOURNAMENT}; {CURIOSITY}"
    )
    """Selection of parents: every elite with equal probability (uniform), the fittest of three
    such draws (tournament), half of the parents each way (mixed), or mixed and more often those
    whose children have entered (curiosity)."""


class RandomEmitter(WeightedEmitter):
    """New random genomes: a baseline that learns nothing."""

    operator: Literal["random"] = "random"


class NeatEmitter(SelectingEmitter):
    """Elites varied by NEAT's mutations, some crossed with another elite first."""

    model_config = sourced(f"{NEAT}, sections 3.1 and 3.2")

    operator: Literal["neat"] = "neat"
    crossover: Rate = 0.0
    """Probability of crossover with a second parent."""


class LineEmitter(SelectingEmitter):
    """An elite plus an isotropic step and a step along the line to another elite."""

    model_config = sourced(LINE)

    operator: Literal["iso+line"] = "iso+line"
    iso: float = field(0.1, gt=0.0, le=2.0)
    """Standard deviation of the isotropic step; genes lie within ±1."""
    line: float = field(0.2, gt=0.0, le=2.0)
    """Standard deviation of the step along the line, relative to the line's length."""


class GaussianEmitter(SelectingEmitter):
    """An elite plus an isotropic step."""

    operator: Literal["gaussian"] = "gaussian"
    step: float = field(0.1, gt=0.0, le=2.0)
    """Standard deviation of the step; genes lie within ±1."""


class CmaMaeEmitter(WeightedEmitter):
    """CMA-MAE: evolution strategies that improve on thresholds, which follow the archive."""

    model_config = sourced(CMA_MAE)

    operator: Literal["cma-mae"] = "cma-mae"
    step: float = field(0.2, gt=0.0, le=2.0)
    """Initial standard deviation; genes lie within ±1."""
    learning_rate: Rate = 0.01
    """Rate at which a cell's threshold follows the fitness found there; 0: CMA-ES."""
    threshold: float = field(0.0, unit="fitness")
    """Threshold of empty cells."""
    emitters: int = field(1, ge=1, le=64)
    """Strategies that share the thresholds, each with an equal part of the offspring."""


class CmaMeEmitter(WeightedEmitter):
    """CMA-ME's improvement emitters of QDax, which must be installed."""

    model_config = sourced(CMA_ME)

    operator: Literal["cma-me"] = "cma-me"
    step: float = field(0.2, gt=0.0, le=2.0)
    """Initial standard deviation; genes lie within ±1."""
    emitters: int = field(1, ge=1, le=64)
    """Emitters that take turns, one per generation."""


class PopulationEmitter(WeightedEmitter):
    """NEAT with its own population (species, fitness sharing, crossover) beside the archive.

    Empty values are those of the preset.
    """

    model_config = sourced(NEAT)

    operator: Literal["population"] = "population"
    preset: Literal["paper", "tensorneat"] = "paper"
    """Settings of Stanley and Miikkulainen (2002) with the mutation rates of `genome`, or the
    defaults of TensorNEAT with its own rates."""
    backend: Literal["microcosmos", "tensorneat"] = "microcosmos"
    """Implementation: ours, or TensorNEAT with its defaults if it is installed."""
    threshold: float | None = field(None, gt=0.0, le=1e3)
    """Compatibility distance within which networks belong to one species."""
    target_species: int | None = field(None, ge=0, le=1000, unit="species")
    """Number of species that the threshold is adjusted towards; 0: fixed threshold."""
    stagnation: int | None = field(None, ge=1, unit="generations")
    """Generations without improvement after which a species has no offspring."""
    survival: float | None = field(None, gt=0.0, le=1.0)
    """Fittest share of a species from which parents are drawn."""
    crossover: float | None = field(None, ge=0.0, le=1.0)
    """Probability of crossover with a second parent."""


class LamarckianEmitter(SelectingEmitter):
    """NEAT's variation; offspring then learn by gradients and pass on what they learned."""

    model_config = sourced(OMG_MEGA)

    operator: Literal["lamarckian"] = "lamarckian"
    crossover: Rate = 0.0
    """Probability of crossover with a second parent."""
    lessons: int = field(2, ge=1, le=100)
    """Gradient steps on fitness and descriptors. Each takes a forward simulation and one
    backward simulation per gradient, and counts as an evaluation."""
    step: float = field(0.3, gt=0.0, le=100.0)
    """Length of a step in the space of weights and biases."""
    diversity: float = field(1.0, ge=0.0, le=100.0)
    """Standard deviation of the random weight of each descriptor's gradient, relative to the
    fitness gradient; 0: fitness alone."""
    segment: int | None = field(None, ge=1, unit="steps")
    """Steps that a gradient keeps in memory at a time, recomputing the others; empty: all."""


class CmaMegaEmitter(WeightedEmitter):
    """CMA-MEGA: an evolution strategy over gradient steps of fitness and descriptors."""

    model_config = sourced(CMA_MEGA)

    operator: Literal["cma-mega"] = "cma-mega"
    step: float = field(0.5, gt=0.0, le=100.0)
    """Initial standard deviation of the weights of unit gradients; genes lie within ±1."""
    rate: float = field(1.0, gt=0.0, le=10.0)
    """Learning rate of the mean solution towards its best offspring."""
    segment: int | None = field(None, ge=1, unit="steps")
    """Steps that a gradient keeps in memory at a time, recomputing the others; empty: all."""


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
"""One source of offspring."""

VARYING = ("neat", "iso+line", "gaussian")
"""Operators that vary any parents."""
STATELESS = ("random", *VARYING)
"""Operators that learn nothing from the outcome, so that any of their offspring, and any number
of them, may be evaluated."""

USING_GRADIENTS = ("lamarckian", "cma-mega")
"""Operators that need the derivatives of all descriptors."""


def refuse_unfit_emitters(emitters: tuple[Emitter, ...], encoding: str) -> None:
    """Raise `ValueError` where an operator cannot vary an encoding's genomes."""
    vectors = encoding in ("direct", "weights") or plugins.is_plugin(encoding)
    fit, unfit = NETWORK_OPERATORS, VECTOR_OPERATORS
    if vectors:
        fit, unfit = unfit, fit
    for emitter in emitters:
        if emitter.operator in unfit:
            raise ValueError(
                f"`search.emitters` must be random or of {', '.join(fit)} where "
                f"`control.encoding` is {encoding!r}, got {emitter.operator!r}"
            )
    foreign = [getattr(emitter, "backend", None) == "tensorneat" for emitter in emitters]
    if any(foreign) and encoding == "body-graph":
        raise ValueError(
            "`backend` of a population must be 'microcosmos' where `control.encoding` is "
            "'body-graph': TensorNEAT has no body plans, got 'tensorneat'"
        )
    numbering = [
        emitter.operator for emitter in emitters if emitter.operator in NETWORK_OPERATORS
    ]
    if any(foreign) and len(numbering) > 1:
        raise ValueError(
            '`search.emitters` must hold nothing but random beside backend "tensorneat", which '
            f"numbers genes itself, got {', '.join(numbering)}"
        )


def refuse_uneven(emitters: tuple[Emitter, ...], slots: tuple[int, ...]) -> None:
    """Raise `ValueError` where the strategies of CMA-MAE cannot have equal parts."""
    for emitter, count in zip(emitters, slots, strict=True):
        if isinstance(emitter, CmaMaeEmitter) and count % emitter.emitters:
            raise ValueError(
                f"`emitters` of 'cma-mae' must divide its {count} offspring of a generation "
                f"evenly, got {emitter.emitters}. Change `emitters` or `batch`"
            )


def gradients(emitter: Emitter, slots: int) -> int:
    """Return the number of gradients that an emitter needs in a generation."""
    if isinstance(emitter, LamarckianEmitter):
        return emitter.lessons * slots
    return int(isinstance(emitter, CmaMegaEmitter))


def slots(batch: int, shares: tuple[int, ...]) -> tuple[int, ...]:
    """Divide a batch among shares in whole numbers; the largest remainders round up."""
    exact = [batch * share / sum(shares) for share in shares]
    whole = [int(part) for part in exact]
    order = sorted(range(len(shares)), key=lambda i: (whole[i] - exact[i], i))
    for i in order[: batch - sum(whole)]:
        whole[i] += 1
    return tuple(whole)
