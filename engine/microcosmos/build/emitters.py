"""Build the emitters of a spec."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax

from .. import neat, search, spec
from ..experiments.state import Plan
from ..genomes import Encoding
from ..search import emitters, qdax, tensorneat
from ..search.emitters.tensorneat import TensorNeat
from ..spec import emitters as specs
from .cells import build_cells
from .plugins import measures_of


def build_emitters(chosen: spec.Evolution, encoding: Encoding) -> tuple[search.Emitter, ...]:
    """Build the emitters, each with its slots of a generation."""
    pairs = zip(chosen.emitters, chosen.slots, strict=True)
    return tuple(_build(emitter, slots, chosen, encoding) for emitter, slots in pairs)


def build_bandit(chosen: spec.Evolution) -> emitters.Bandit | None:
    """Build what divides each batch among the emitters, if the spec asks for it."""
    asked = getattr(chosen.search, "bandit", None)
    return asked and emitters.Bandit(asked.window, asked.exploration)


def build_emission(plan: Plan) -> Callable[..., Any]:
    """Build the function that emits a generation; see `experiments.offspring.Programs.emit`."""

    def fixed(states, elites, counters, generation, emitter, *, key=plan.key):
        given = states, elites, counters, generation
        return emitters.emit(plan.emitters, *given, key=key)

    def divided(states, elites, counters, generation, emitter, *, key=plan.key):
        given = elites, counters, generation, emitter
        children, counters = emitters.emit_chosen(plan.emitters, *given, key=key)
        return children, states, counters

    return divided if plan.bandit else fixed


BREEDING = 2**31 + 1
"""Number from which the keys of children of chosen creatures derive; no generation has it."""


def build_breeding_emission(plan: Plan) -> Callable[..., Any]:
    """Build the function that emits children of chosen creatures; see
    `experiments.offspring.Programs.breed`. They are drawn by their weights, as curiosity."""

    def by_weight(emitter: Any) -> Any:
        return replace(emitter, select="curiosity") if hasattr(emitter, "select") else emitter

    breeders = tuple(map(by_weight, plan.emitters))

    def bred(parents, counters, generation, emitter):
        key = jax.random.fold_in(plan.key, BREEDING)
        return emitters.emit_chosen(breeders, parents, counters, generation, emitter, key=key)

    return bred


def _build(
    emitter: specs.Emitter, slots: int, chosen: spec.Evolution, encoding: Encoding
) -> search.Emitter:
    newcomer, outputs = encoding.newcomer, 1 + len(chosen.archive.descriptors)
    match emitter:
        case specs.RandomEmitter():
            return emitters.Random(slots, newcomer)
        case specs.NeatEmitter():
            return _neat(emitter, slots, chosen, encoding)
        case specs.PopulationEmitter():
            return _population(emitter, slots, chosen, encoding)
        case specs.LineEmitter():
            return emitters.IsoLine(
                slots, newcomer, emitter.iso, emitter.line, select=emitter.select
            )
        case specs.GaussianEmitter():
            return emitters.IsoLine(slots, newcomer, emitter.step, select=emitter.select)
        case specs.CmaMaeEmitter():
            return emitters.CmaMae(
                slots=slots,
                newcomer=newcomer,
                cells=chosen.archive.cells,
                step=emitter.step,
                learning_rate=emitter.learning_rate,
                threshold=emitter.threshold,
                emitters=emitter.emitters,
            )
        case specs.CmaMeEmitter():
            cells = build_cells(chosen.archive, measures_of(chosen.scene))
            count = emitter.emitters
            return qdax.cma_me(slots, newcomer, cells, step=emitter.step, emitters=count)
        case specs.LamarckianEmitter():
            return emitters.Lamarckian(
                neat=_neat(emitter, slots, chosen, encoding),
                outputs=outputs,
                lessons=emitter.lessons,
                step=emitter.step,
                diversity=emitter.diversity,
            )
        case specs.CmaMegaEmitter():
            return emitters.CmaMega(slots, newcomer, outputs, emitter.step, emitter.rate)


def _neat(
    emitter: specs.NeatEmitter | specs.LamarckianEmitter,
    slots: int,
    chosen: spec.Evolution,
    encoding: Encoding,
) -> emitters.Neat:
    rates, inputs = build_rates(chosen), len(chosen.control.inputs)
    return emitters.Neat(
        slots, encoding.newcomer, rates, inputs, emitter.crossover, emitter.select
    )


def _population(
    emitter: specs.PopulationEmitter, slots: int, chosen: spec.Evolution, encoding: Encoding
) -> search.Emitter:
    settings = build_settings(emitter, chosen, slots)
    inputs, outputs = len(chosen.control.inputs), len(chosen.control.outputs)
    if emitter.backend == "tensorneat":
        assert encoding.room is not None
        backend = tensorneat.build(settings, inputs, outputs, *encoding.room)
        return TensorNeat(slots, backend, chosen.seed)
    return emitters.PopulationNeat(slots, encoding.newcomer, settings, inputs, outputs)


def build_settings(
    emitter: specs.PopulationEmitter, chosen: spec.Evolution, slots: int
) -> neat.Settings:
    whole = neat.PRESETS[emitter.preset]
    rates = build_rates(chosen)
    if emitter.preset != "paper":  # TensorNEAT's rates, over all activations.
        rates = replace(whole.rates, palette=rates.palette, recurrent=rates.recurrent)
    names = ("threshold", "target_species", "stagnation", "survival", "crossover")
    given = {name: getattr(emitter, name) for name in names}
    given = {name: value for name, value in given.items() if value is not None}
    return replace(whole, rates=rates, population=slots, **given)


def build_plan_rates(chosen: spec.Evolution) -> neat.PlanRates | None:
    """Build the mutation rates of body plans; None for bodies without a plan."""
    if not isinstance(chosen.body, spec.GrownBody):
        return None
    genome = chosen.genome
    return neat.PlanRates(
        limits=chosen.body.genes,
        structure=genome.body_rate,
        values=genome.segment_rate,
        vary=genome.shape_rate,
    )


def build_rates(chosen: spec.Evolution) -> neat.Rates:
    """Build NEAT's mutation rates."""
    genome = chosen.genome
    return neat.Rates(
        weight=genome.weight_rate,
        weight_step=genome.weight_step,
        replace=genome.replace_rate,
        activation=genome.activation_rate,
        toggle=genome.toggle_rate,
        add_node=genome.add_node_rate,
        add_connection=genome.add_connection_rate,
        recurrent=getattr(chosen.control, "recurrent", False),
        plan=build_plan_rates(chosen),
    )
