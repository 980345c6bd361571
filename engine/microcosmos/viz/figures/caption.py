"""Captions: the search, the world, the device; groups, tests and physical units."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from ...archive.curves import CORRECTED, curve_title
from ...archive.variety import KIND
from ...exports import si
from ...exports.run_file import fitness_of
from ...quantities.real import Real, like, shown, square
from ...spec import Chain
from ...spec.body import GrownBody, PluginBody, SwimmerBody, shape
from ...spec.emitters import PopulationEmitter
from ...spec.paths import number_text, short
from ...statistics import Aggregates, Comparison, Group, wording
from ...statistics.effects import quartiles
from ...statistics.groups import devices, versions
from ...statistics.measures import values_of
from .reading import Archive, Axis, Described, Search, chosen, plugins_of
from .sheet import Layout, Motion
from .strips import Strip

ENCODINGS = {
    "cppn": "CPPN",
    "body-graph": "CPPN that knows the place of each node",
}
"""Controllers whose names differ from those of their encodings."""
CONTAINERS = {
    "fronts": "a Pareto front in each cell",
    "dominated-novelty": "dominated novelty in place of cells",
    "learned": "learned axes",
}


def of_archive(archive: Archive, names: list[str] | None) -> str:
    """Return the caption of a map."""
    along = chosen(archive, names)
    fittest = "the ring marks the fittest" if len(along) == 2 else "the fittest has"
    best = (
        f"({archive.fitness.max():.3g})" if len(along) == 2 else f"{archive.fitness.max():.3g}"
    )
    first = f"{_elites(archive)} over {_over(along)}; {fittest} {best}."
    own = {axis.name for axis in archive.axes}
    if archive.pool or {axis.name for axis in along} != own:
        first += " Where elites share a place, the fittest is shown."
    return " ".join([first, run(archive)])


def _elites(archive: Archive) -> str:
    """Return the numbers of elites and cells, and the coverage."""
    number, cells = len(archive.cells), archive.spec.archive.cells
    if archive.pool:
        share = f"{100 * archive.curves['coverage'][-1]:.1f} %"
        covered = f"{'it covers' if number == 1 else 'they cover'} {share} of {cells:,} cells"
        return f"Archive of {_count(number, 'elite')}; {covered}"
    share = f"{100 * number / cells:.1f} %"
    return f"Archive of {_count(number, 'elite')} in {_count(cells, 'cell')} ({share})"


def of_curves(
    groups: Sequence[Group], shown: Sequence[str], against: str = "evaluations"
) -> str:
    """Return the caption of curves: the first spec, and what differs in others."""
    several = any(len(group.runs) > 1 for group in groups)
    first = _listed([curve_title(name) for name in shown])
    first = first[0].upper() + first[1:]
    if several:
        first += ": median over seeds (thick), band between the quartiles, single runs (thin)"
    if any(len({len(run.curves["best"]) for run in group.runs}) > 1 for group in groups):
        first += "; medians and bands end with the shortest run"
    again = [one.curves.get(CORRECTED[0], np.nan) for group in groups for one in group.runs]
    if against == "evaluations" and any(np.isfinite(one).any() for one in again):
        first += "; evaluations count those of elites again"
    cautions = wording.machines(versions(groups), devices(groups))
    cautions += wording.negative(shown, groups)
    if not groups[0].name:  # Files of one spec.
        seeds = groups[0].seeds
        return " ".join([first + ".", *cautions, run(groups[0].runs[0], seeds=seeds)])
    compared = [wording.described(groups), *cautions, _rest(groups[0].runs[0])]
    return " ".join([first + ".", *compared])


def of_sheet(archive: Archive, plan: Layout, motions: Sequence[Motion], moments: int) -> str:
    """Return the caption of a contact sheet."""
    first = (
        f"The fittest elite of each of {_count(len(plan.regions), 'region')} over "
        f"{_over(plan.axes)}, at {_count(moments, 'moment')} of its "
        f"{_count(archive.spec.task.steps, 'step')}, pale at the start, at "
        f"the end in the colour of its fitness; numbers give its fitness, thin lines the way "
        f"of its mean node. All bodies are at one scale."
    )
    if any(motion.trusted is not None for motion in motions):
        first += " Trusted or not is the verdict of the physics audit; the others have none."
    return " ".join([first, run(archive)])


def of_strips(runs: Group, shown: Sequence[Strip], moments: int) -> str:
    """Return the caption of film strips of kinds of motion."""
    elites = sum(len(one.cells) for one in runs.runs)
    of_runs = f" of {len(runs.seeds)} runs" if len(runs.seeds) > 1 else ""
    kinds = "kind" if len(shown) == 1 else f"{len(shown)} kinds"
    first = (
        f"The fittest {kinds} of motion among {_count(elites, 'elite')}{of_runs}: "
        f"from the fittest on, each is more than {KIND:g} body lengths (motion distance) from "
        f"all before it. "
        f"{moments} moments of one stroke, in order and from dark to light; the dot marks the "
        f"first node. Bodies have one scale and travel upwards; the arrow is the way of one "
        f"stroke, the number the fitness."
    )
    return " ".join([first, run(runs.runs[0], seeds=runs.seeds)])


def of_lineage(archive: Archive, cell: int | None, ancestors: int) -> str:
    """Return the caption of a tree."""
    row = archive.row(cell)
    who = "fittest elite" if cell is None else f"elite of cell {cell}"
    first = (
        f"Descent of {_count(len(archive.cells), 'elite')} (grey) and the "
        f"{_count(ancestors, 'ancestor')} of the {who} (ring; fitness "
        f"{archive.fitness[row]:.3g}), coloured by fitness."
    )
    if np.any(archive.lineage["parents"][:, 1]):
        first += " Dashed lines lead from second parents."
    return " ".join([first, run(archive)])


def run(described: Described, seeds: Sequence[int] | None = None) -> str:
    """Return the spec and the machine, in three sentences."""
    spec = described.spec
    seeds = [spec.seed] if seeds is None else seeds
    seeded = f", {_seeds(seeds)}" if seeds else ""
    columns = described.curves
    done, evaluations = len(columns["evaluations"]), int(columns["evaluations"][-1])
    method = "NEAT" if spec.experiment == "neuroevolution" else "MAP-Elites"
    if spec.archive.container is not None:
        method += f" with {CONTAINERS[spec.archive.container.kind]}"
    return (
        f"{method} ({_emitters(spec)}), {_count(done, 'generation')} of {spec.search.batch} "
        f"({_count(evaluations, 'evaluation')}{seeded}). {_fitness(spec)} over "
        f"{_count(spec.task.steps, 'step')}; {_body(spec)}, {_control(spec)}, in a periodic "
        f"world of {spec.world.width} × "
        f"{spec.world.height} cells{_fluid(spec)}. "
        f"Microcosmos {described.version} on {_device(described.devices)}."
    )


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


def _fitness(spec: Search) -> str:
    task = spec.task
    if task.plugin:
        return f"Fitness is “{task.plugin.title}” ({task.fitness})"
    return (
        "Fitness is "
        + {
            "speed": "the speed of swimming",
            "displacement": "the displacement of the mean node",
            "energy": "the energy collected",
            "displacement+energy": f"displacement + {task.energy_weight:g} × energy collected",
            "cost_of_transport": "minus the work on the fluid per body length",
            "upstream": "the speed along −x, against the flow",
            "through": "the speed along x",
        }[task.fitness]
    )


def _emitters(spec: Search) -> str:
    names = [
        "a population of its own" if isinstance(one, PopulationEmitter) else one.operator
        for one in spec.emitters
    ]
    plural = "emitters" if len(names) > 1 else "emitter"
    return names[0] if names[0].startswith("a ") else f"{plural} {', '.join(names)}"


def _body(spec: Search) -> str:
    body = spec.body
    if isinstance(body, PluginBody):
        return f"the body “{body.plugin.title}” ({body.builder})"
    if isinstance(body, GrownBody):
        return f"bodies of up to {body.nodes} nodes that grow from plans"
    nodes = len(shape(body).positions)
    if isinstance(body, Chain):
        return f"a filament of {nodes} nodes"
    whole = "the body of a" if isinstance(body, SwimmerBody) else "a"
    return f"{whole} {body.builder} of {nodes} nodes"


def _control(spec: Search) -> str:
    control = spec.control
    name = ENCODINGS.get(control.encoding, f"{control.encoding} encoding")
    timer = getattr(control, "timer", "sine-cosine")
    period = f"period {control.period:g} steps" if timer == "sine-cosine" else "linear timer"
    return f"controlled by a {name} ({period})"


def _fluid(spec: Search) -> str:
    if not spec.world.fluid:
        return " without a fluid"
    viscosity = f", ν = {spec.world.viscosity:g} cells²/step"
    return viscosity + " (coupling not force-free)" * (not spec.coupling.force_free)


def _device(devices: Sequence[str]) -> str:
    models = [", ".join(device.split(", ")[:2]) for device in devices]  # Without the software.
    return " and ".join(dict.fromkeys(models))


def _seeds(seeds: Sequence[int]) -> str:
    return ("seed " if len(seeds) == 1 else "seeds ") + ", ".join(map(str, seeds))


def _listed(words: Sequence[str]) -> str:
    *others, last = words
    return f"{', '.join(others)} and {last}" if others else last


def _over(axes: Sequence[Axis]) -> str:
    return " and ".join(axis.label[0].lower() + axis.label[1:] for axis in axes)


def of_boxes(comparison: Comparison) -> str:
    """Return the caption of boxes with all points."""
    first = (
        f"{_measures(comparison)}: every run (points), the median of each group (line) and the "
        "quartiles (box)."
    )
    return " ".join([first, *_triangles(comparison), *_stated(comparison)])


def of_parameter(comparison: Comparison, path: str) -> str:
    """Return the caption of measures against a parameter."""
    first = (
        f"{_measures(comparison)} against {short(path)} (`{path}`): median over seeds (line), "
        "band between the quartiles, every run (points)."
    )
    return " ".join([first, *_triangles(comparison), *_stated(comparison)])


def of_profiles(aggregates: Aggregates, first_run: Described) -> str:
    """Return the caption of performance profiles."""
    band = "" if aggregates.refusal else ", with 95 % bands"
    first = (
        f"Performance profiles of {aggregates.measure.title}: the share of runs with a greater "
        f"score{band}."
    )
    return " ".join([first, wording.aggregated(aggregates), _rest(first_run)])


def _triangles(comparison: Comparison) -> list[str]:
    """Return sentences that explain the triangles of a figure, if it has any."""
    values = {
        x for result in comparison.results for one in result.summaries for x in one.values
    }
    sentences = {
        inf: "Triangles at the top are runs that do not reach the value.",
        -inf: "Triangles at the bottom are runs without elites.",
    }
    return [text for value, text in sentences.items() if value in values]


def _measures(comparison: Comparison) -> str:
    titles = [result.measure.title for result in comparison.results]
    letters = [f"({chr(97 + i)}) " if len(titles) > 1 else "" for i in range(len(titles))]
    named = ", ".join(map("".join, zip(letters, titles, strict=True)))
    return named if len(titles) > 1 else named[0].upper() + named[1:]


def _stated(comparison: Comparison) -> list[str]:
    sentences = [
        wording.groups(comparison),
        wording.tested(comparison),
        wording.results(comparison),
    ]
    sentences += wording.cautions(comparison)
    return [one for one in sentences if one] + [_rest(comparison.groups[0].runs[0])]


def _rest(first: Described) -> str:
    return f"All else as in the first run: {run(first, seeds=())}"


MOST_GROUPS = 6
"""Groups whose numbers a caption states one by one."""
OF_FITNESS = ("best", "mean")
"""Curves in the unit of fitness. A QD score adds up elites, so it is not a speed."""


@dataclass(frozen=True)
class Stated:
    """A number in the unit of fitness, of each group."""

    title: str
    values: Sequence[float]


def curves_in_units(groups: Sequence[Group], shown_curves: Sequence[str], real: Real) -> str:
    """Return a sentence on the last medians of curves over the seeds of each group.

    Raises `ValueError` for a run without a fluid or a stroke.
    """
    stated = [
        Stated(f"median {curve_title(name)} at the end", [_last(one, name) for one in groups])
        for name in shown_curves
        if name in OF_FITNESS
    ]
    return _sentence(
        [one.name for one in groups], [one.runs[0] for one in groups], stated, real
    )


def _last(group: Group, name: str) -> float:
    """Return the last median of a curve, where the shortest run ends."""
    curves = [values_of(run.curves, name) for run in group.runs]
    end = min(map(len, curves)) - 1
    return quartiles(np.array([values[end] for values in curves]))[1]


def comparison_in_units(comparison: Comparison, real: Real) -> str:
    """Return a sentence on the medians, and on values to reach, of compared groups.

    Raises `ValueError` for a run without a fluid or a stroke.
    """
    stated = []
    for result in comparison.results:
        measure = result.measure
        if measure.curve not in OF_FITNESS:
            continue
        if measure.reaches is None:
            values = [one.median for one in result.summaries]
            stated.append(Stated(f"median {measure.title}", values))
        else:
            name = curve_title(measure.curve)
            values = [measure.reaches] * len(comparison.groups)
            stated.append(Stated(f"{name} of {number_text(measure.reaches)}", values))
    names = [one.name for one in comparison.groups]
    return _sentence(names, [one.runs[0] for one in comparison.groups], stated, real)


def _sentence(
    names: Sequence[str], runs: Sequence[Any], stated: Sequence[Stated], real: Real
) -> str:
    scaled = [si.of_scene(run.spec.scene, real) for run in runs]
    fluids = [one.viscosity(run.spec.scene) for one, run in zip(scaled, runs, strict=True)]
    parts = []
    for one in stated:
        numbers = [
            _in_units(name, value, run, of_run)
            for name, value, run, of_run in zip(names, one.values, runs, scaled, strict=True)
            if np.isfinite(value)  # Others have no elites.
        ]
        known = [number for number in numbers if number is not None]
        # A number without a dimension is left out for all groups, not for some.
        if known and len(known) == len(numbers):
            parts.append(f"the {one.title} is {_each(known, len(known) < len(names))}")
    known = [
        InUnits(name, fluid, "m²/s", f"{square(fluid)}, {like(fluid)}")
        for name, fluid in zip(names, fluids, strict=True)
        if fluid is not None
    ]
    if len(known) == len(names):
        parts.append(f"the kinematic viscosity is {_each(known)}")
    given = (
        f"With a body of {shown(real.length, 'm')} and a stroke of {shown(real.period, 's')} "
        "at the clock's own pace"
    )
    if not parts:
        return f" {given}, no number of this figure has a physical unit."
    whole = ", and ".join(["; ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)
    return f" {given}, {whole}."


@dataclass(frozen=True)
class InUnits:
    """A number of a group in a unit of SI, and its text."""

    group: str
    value: float
    unit: str
    text: str


def _in_units(name: str, value: float, run: Any, scaled: si.Scaled) -> InUnits | None:
    """Return a number in the unit of fitness in SI units; None where it has no dimension."""
    spec = run.spec
    unit = si.UNITS.get(fitness_of(spec.task.model_dump(), plugins_of(spec)))
    factor = None if unit is None else scaled.factor(unit)
    if unit is None or factor is None:
        return None
    number = value * float(factor)
    return InUnits(
        name, number, f"{unit.si}{unit.about}", f"{shown(number, unit.si)}{unit.about}"
    )


def _each(numbers: Sequence[InUnits], named: bool = False) -> str:
    """Return one text, one for each group by name, or the least and the greatest of many in one
    unit.

    A text of all groups has no names, unless it is `named`.
    """
    if len({one.text for one in numbers}) == 1 and not named:
        return numbers[0].text
    if len(numbers) > MOST_GROUPS and len({one.unit for one in numbers}) == 1:
        ends = (function(numbers, key=lambda one: one.value) for function in (min, max))
        return " to ".join(f"{one.text} ({one.group})" for one in ends)
    return ", ".join(f"{one.text} ({one.group})" for one in numbers)
