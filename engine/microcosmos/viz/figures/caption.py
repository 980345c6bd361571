"""Captions that state the spec: the search, the world, the length, the device."""

from collections.abc import Sequence

import numpy as np

from ...archive.variety import KIND
from ...spec import Chain
from ...spec.body import GrownBody, PluginBody, SwimmerBody, shape
from ...spec.emitters import PopulationEmitter
from .axes import Axis, chosen
from .groups import Group
from .reading import Archive, Described, Search
from .sheet import Layout, Motion
from .strips import Strip

NAMES = {"best": "best fitness", "mean": "mean fitness", "qd_score": "QD score"}
"""Names of curves that differ from those of their columns."""
ENCODINGS = {
    "cppn": "CPPN",
    "cppn-body": "CPPN for body and control",
    "body-graph": "CPPN that knows the place of each node",
}
"""Controllers whose names differ from those of their encodings."""
CONTAINERS = {
    "fronts": "a Pareto front in each cell",
    "dominated-novelty": "dominated novelty in place of cells",
    "learned": "learned axes",
}


def of_archive(found: Archive, names: list[str] | None) -> str:
    """Return the caption of a map."""
    along = chosen(found, names)
    fittest = "the ring marks the fittest" if len(along) == 2 else "the fittest has"
    best = f"({found.fitness.max():.3g})" if len(along) == 2 else f"{found.fitness.max():.3g}"
    first = f"{_elites(found)} over {_over(along)}; {fittest} {best}."
    own = {axis.name for axis in found.axes}
    if found.pool or {axis.name for axis in along} != own:
        first += " Where elites share a place, the fittest is shown."
    return " ".join([first, run(found)])


def _elites(found: Archive) -> str:
    """Return the numbers of elites and cells, and the coverage."""
    number, cells = len(found.cells), found.spec.archive.cells
    if found.pool:
        covered = f"they cover {100 * found.curves['coverage'][-1]:.1f} % of {cells:,} cells"
        return f"Archive of {number:,} elites; {covered}"
    return f"Archive of {number:,} elites in {cells:,} cells ({100 * number / cells:.1f} %)"


def of_curves(groups: Sequence[Group], shown: Sequence[str]) -> str:
    """Return the caption of curves: the first spec, and what differs in others."""
    several = any(len(group.runs) > 1 for group in groups)
    first = _listed([NAMES.get(name, name.replace("_", " ")) for name in shown])
    first = first[0].upper() + first[1:]
    if several:
        first += ": median over seeds (thick), band between the quartiles, single runs (thin)"
    if any(len({len(run.curves["best"]) for run in group.runs}) > 1 for group in groups):
        first += "; medians and bands end with the shortest run"
    named = "; ".join(
        f"{group.label}: {_seeds(group.seeds)}" for group in groups if group.label
    )
    compared = [f"Runs differ in {named}."] if named else []
    common = run(groups[0].runs[0], seeds=() if named else groups[0].seeds)
    common = f"All else as in the first run: {common}" if named else common
    return " ".join([first + ".", *compared, common])


def of_sheet(found: Archive, plan: Layout, motions: Sequence[Motion], moments: int) -> str:
    """Return the caption of a contact sheet."""
    first = (
        f"The fittest elite of each of {len(plan.regions)} regions over {_over(plan.axes)}, "
        f"at {moments} moments of its {found.spec.task.steps:,} steps, pale at the start, at "
        f"the end in the colour of its fitness; numbers give its fitness, thin lines the way "
        f"of its mean node. All bodies are at one scale."
    )
    if any(motion.trusted is not None for motion in motions):
        first += " Trusted or not is the verdict of the physics audit; the others have none."
    return " ".join([first, run(found)])


def of_strips(runs: Group, shown: Sequence[Strip], moments: int) -> str:
    """Return the caption of film strips of kinds of motion."""
    elites = sum(len(one.cells) for one in runs.runs)
    of_runs = f" of {len(runs.seeds)} runs" if len(runs.seeds) > 1 else ""
    first = (
        f"The fittest {len(shown)} kinds of motion among {elites:,} elites{of_runs}: "
        f"from the fittest on, each is more than {KIND:g} body lengths (motion distance) from "
        f"all before it. "
        f"{moments} moments of one stroke, in order and from dark to light; the dot marks the "
        f"first node. Bodies have one scale and travel upwards; the arrow is the way of one "
        f"stroke, the number the fitness."
    )
    return " ".join([first, run(runs.runs[0], seeds=runs.seeds)])


def of_lineage(found: Archive, cell: int | None, ancestors: int) -> str:
    """Return the caption of a tree."""
    row = found.row(cell)
    who = "fittest elite" if cell is None else f"elite of cell {cell}"
    first = (
        f"Descent of {len(found.cells):,} elites (grey) and the {ancestors} ancestors of the "
        f"{who} (ring; fitness {found.fitness[row]:.3g}), coloured by fitness."
    )
    if np.any(found.lineage["parents"][:, 1]):
        first += " Dashed lines lead from second parents."
    return " ".join([first, run(found)])


def run(found: Described, seeds: Sequence[int] | None = None) -> str:
    """Return the spec and the machine, in three sentences."""
    spec = found.spec
    seeds = [spec.seed] if seeds is None else seeds
    seeded = f", {_seeds(seeds)}" if seeds else ""
    columns = found.curves
    done, evaluations = len(columns["evaluations"]), int(columns["evaluations"][-1])
    method = "NEAT" if spec.experiment == "neuroevolution" else "MAP-Elites"
    if spec.archive.container is not None:
        method += f" with {CONTAINERS[spec.archive.container.kind]}"
    return (
        f"{method} ({_emitters(spec)}), {done:,} generations of {spec.search.batch} "
        f"({evaluations:,} evaluations{seeded}). {_fitness(spec)} over {spec.task.steps:,} "
        f"steps; {_body(spec)}, {_control(spec)}, in a periodic world of {spec.world.width} × "
        f"{spec.world.height} cells{_fluid(spec)}. "
        f"Microcosmos {found.version} on {_device(found.devices)}."
    )


def _fitness(spec: Search) -> str:
    task = spec.task
    if task.plugin:
        return f"Fitness is “{task.plugin.title}” ({task.fitness})"
    return "Fitness is " + {
        "speed": "the speed of swimming",
        "displacement": "the displacement of the mean node",
        "energy": "the energy collected",
    }.get(task.fitness, f"displacement + {task.energy_weight:g} × energy collected")


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
