"""From the words for emitters to what makes children."""

from dataclasses import replace
from functools import singledispatch

from .. import neat, search, spec
from ..genomes import Encoding
from ..search import emitters, qdax, tensorneat
from ..search.emitters.tensorneat import TensorNeat
from ..spec import emitters as words
from .cells import build_cells
from .plugins import measures_of


def build_emitters(chosen: spec.Evolution, encoding: Encoding) -> tuple[search.Emitter, ...]:
    """The sources of children, each with its slots of a generation."""
    pairs = zip(chosen.emitters, chosen.slots, strict=True)
    return tuple(_build(emitter, slots, chosen, encoding) for emitter, slots in pairs)


@singledispatch
def _build(
    emitter: words.Emitter,
    slots: int,
    chosen: spec.Evolution,
    encoding: Encoding,
) -> search.Emitter:
    raise TypeError(f"`emitters` must be known ones, got {type(emitter).__name__}")


@_build.register
def _(emitter: words.RandomEmitter, slots, chosen, encoding):
    return emitters.Random(slots, encoding.newcomer)


@_build.register
def _(emitter: words.NeatEmitter, slots, chosen, encoding):
    rates, inputs = build_rates(chosen), len(chosen.control.inputs)
    return emitters.Neat(slots, encoding.newcomer, rates, inputs, emitter.crossover)


@_build.register
def _(emitter: words.PopulationEmitter, slots, chosen, encoding):
    settings = build_settings(emitter, chosen, slots)
    inputs, outputs = len(chosen.control.inputs), len(chosen.control.outputs)
    if emitter.backend == "tensorneat":
        backend = tensorneat.build(settings, inputs, outputs, *encoding.room)
        return TensorNeat(slots, backend, chosen.seed)
    return emitters.population.Neat(slots, encoding.newcomer, settings, inputs, outputs)


@_build.register
def _(emitter: words.LineEmitter, slots, chosen, encoding):
    return emitters.IsoLine(slots, encoding.newcomer, emitter.iso, emitter.line)


@_build.register
def _(emitter: words.GaussianEmitter, slots, chosen, encoding):
    return emitters.IsoLine(slots, encoding.newcomer, emitter.step)


@_build.register
def _(emitter: words.CmaMaeEmitter, slots, chosen, encoding):
    return emitters.CmaMae(
        slots=slots,
        newcomer=encoding.newcomer,
        cells=chosen.archive.cells,
        step=emitter.step,
        learning_rate=emitter.learning_rate,
        threshold=emitter.threshold,
    )


@_build.register
def _(emitter: words.CmaMeEmitter, slots, chosen, encoding):
    cells, asked = build_cells(chosen.archive, measures_of(chosen.scene)), emitter.emitters
    return qdax.cma_me(slots, encoding.newcomer, cells, step=emitter.step, emitters=asked)


@_build.register
def _(emitter: words.LamarckianEmitter, slots, chosen, encoding):
    rates, inputs = build_rates(chosen), len(chosen.control.inputs)
    return emitters.Lamarckian(
        neat=emitters.Neat(slots, encoding.newcomer, rates, inputs, emitter.crossover),
        outputs=1 + len(chosen.archive.descriptors),
        lessons=emitter.lessons,
        step=emitter.step,
        diversity=emitter.diversity,
    )


@_build.register
def _(emitter: words.CmaMegaEmitter, slots, chosen, encoding):
    return emitters.CmaMega(
        slots=slots,
        newcomer=encoding.newcomer,
        outputs=1 + len(chosen.archive.descriptors),
        step=emitter.step,
        rate=emitter.rate,
    )


def build_settings(
    emitter: words.PopulationEmitter, chosen: spec.Evolution, slots: int
) -> neat.Settings:
    """How a population is divided, selected and varied."""
    whole = neat.PRESETS[emitter.preset]
    rates = build_rates(chosen)
    if emitter.preset != "paper":  # Its own rates, among all activations.
        rates = replace(whole.rates, palette=rates.palette, recurrent=rates.recurrent)
    names = ("threshold", "target_species", "stagnation", "survival", "crossover")
    given = {name: getattr(emitter, name) for name in names}
    given = {name: value for name, value in given.items() if value is not None}
    return replace(whole, rates=rates, population=slots, **given)


def build_rates(chosen: spec.Evolution) -> neat.Rates:
    """How often each of NEAT's mutations happens."""
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
    )
