"""From the words for emitters to what makes children."""

from functools import singledispatch

from .. import neat, search, spec
from ..genomes import Encoding
from ..search import emitters
from ..spec import emitters as words


def build_emitters(
    chosen: spec.QualityDiversity, encoding: Encoding
) -> tuple[search.Emitter, ...]:
    """The sources of children, each with its slots of a generation."""
    pairs = zip(chosen.search.emitters, chosen.search.slots, strict=True)
    return tuple(_build(emitter, slots, chosen, encoding) for emitter, slots in pairs)


@singledispatch
def _build(
    emitter: words.Emitter, slots: int, chosen: spec.QualityDiversity, encoding: Encoding
) -> search.Emitter:
    raise TypeError(f"`emitters` must be known ones, got {type(emitter).__name__}")


@_build.register
def _(emitter: words.RandomEmitter, slots, chosen, encoding):
    return emitters.Random(slots, encoding.newcomer)


@_build.register
def _(emitter: words.NeatEmitter, slots, chosen, encoding):
    rates, inputs = build_rates(chosen.genome), len(chosen.control.inputs)
    return emitters.Neat(slots, encoding.newcomer, rates, inputs, emitter.crossover)


@_build.register
def _(emitter: words.LineEmitter, slots, chosen, encoding):
    return emitters.IsoLine(slots, encoding.newcomer, emitter.iso, emitter.line)


@_build.register
def _(emitter: words.GaussianEmitter, slots, chosen, encoding):
    return emitters.IsoLine(slots, encoding.newcomer, emitter.step)


def build_rates(genome: spec.Genome) -> neat.Rates:
    """How often each of NEAT's mutations happens."""
    return neat.Rates(
        weight=genome.weight_rate,
        weight_step=genome.weight_step,
        replace=genome.replace_rate,
        activation=genome.activation_rate,
        toggle=genome.toggle_rate,
        add_node=genome.add_node_rate,
        add_connection=genome.add_connection_rate,
    )
