"""Build the cells of an archive or another container, and the emitters of a search."""

from collections.abc import Callable
from typing import Any

from .. import neat, search, spec
from ..archive.axes import floors
from ..genomes import Encoding
from ..measures import MEASURES
from ..operators import EMITTERS, OPERATORS
from ..search import emitters, qdax
from ..spec import containers
from ..spec.emitters import PluginEmitter
from .plugins import build_plugin_emitter


def build_container(
    archive: spec.Archive, measures: tuple[str, ...] = search.MEASURES
) -> search.Container:
    """Build the archive's container over recorded measures."""
    cells = build_cells(archive, measures)
    match archive.container:
        case containers.DominatedNovelty(size=size, neighbours=neighbours):
            return search.DominatedNovelty(cells, size, neighbours)
        case containers.Fronts(measure=name, goal=goal, size=size):
            usual = MEASURES[name]
            ends = usual.low, usual.high
            second = search.Axis(measures.index(name), *ends, 1, usual.scale == "log10")
            return search.Fronts(cells, second, size, goal == "least")
        case containers.LearnedAxes(axes=axes, bins=bins, first=first, measures=chosen):
            names = chosen or measures
            columns = tuple(measures.index(name) for name in names)
            given = {"axes": axes, "bins": bins, "first": first}
            return search.learned_axes(cells, columns, floors=floors(names), **given)
    return cells


def build_cells(
    archive: spec.Archive, measures: tuple[str, ...] = search.MEASURES
) -> search.Cells:
    """Build the archive's cells over recorded measures."""
    axes = build_axes(archive, measures)
    if archive.centroids is None:
        return search.Grid(axes)
    centroids = search.cvt.centroids(archive.centroids, len(axes), archive.seed)
    return search.voronoi(axes, centroids)


def build_axes(
    archive: spec.Archive, measures: tuple[str, ...] = search.MEASURES
) -> tuple[search.Axis, ...]:
    """Build the archive's axes over recorded measures."""
    return tuple(
        search.Axis(
            measure=measures.index(axis.name),
            low=axis.low,
            high=axis.high,
            bins=axis.bins,
            logarithmic=axis.scale == "log10",
        )
        for axis in archive.descriptors
    )


BUILDERS: dict[str, Callable[[Any, emitters.Problem], search.Emitter]] = {
    "random": emitters.build_random,
    "neat": emitters.build_neat,
    "iso+line": emitters.build_line,
    "gaussian": emitters.build_gaussian,
    "cma-me": qdax.build_cma_me,
    "cma-mae": emitters.build_cma_mae,
    "population": emitters.build_population,
    "cma-mega": emitters.build_cma_mega,
}
"""The builder of each built-in emitter, from its part of the spec and the problem."""


def operators_of(chosen: spec.Evolution) -> tuple[str, ...]:
    """Return the names of the operators of a search, by number: plug-ins last."""
    foreign = (one.operator for one in chosen.emitters if isinstance(one, PluginEmitter))
    return (*OPERATORS, *dict.fromkeys(foreign))


def build_emitters(
    chosen: spec.Evolution, encoding: Encoding, cells: search.Cells
) -> tuple[search.Emitter, ...]:
    """Build the emitters, each with its slots of a generation."""
    operators, rates = operators_of(chosen), build_rates(chosen)

    def built(emitter: spec.Emitter, slots: int) -> search.Emitter:
        name = emitter.operator
        problem = emitters.Problem(
            slots=slots,
            operator=operators.index(EMITTERS.get(name, (name,))[0]),
            newcomer=encoding.newcomer,
            cells=cells,
            seed=chosen.seed,
            rates=rates,
            inputs=len(chosen.control.inputs),
            outputs=len(chosen.control.outputs),
            room=encoding.room,
        )
        if isinstance(emitter, PluginEmitter):
            return build_plugin_emitter(emitter, problem)
        return BUILDERS[name](emitter, problem)

    pairs = zip(chosen.emitters, chosen.slots, strict=True)
    return tuple(built(emitter, slots) for emitter, slots in pairs)


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
