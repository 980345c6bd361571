"""Build the parts of a search from its spec: the registry of optional behaviours."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import jax

from .. import device, genomes, search, spec
from ..archive import creature, export, file
from ..archive.initial import genes_of
from ..search import emitters
from ..search.disturbance import Spread
from ..search.loop import OFFSPRING, Part, Plan, Program, Programs
from ..search.parts import (
    breeding,
    containers,
    initial,
    lessons,
    records,
    reevaluation,
    screening,
)
from ..search.parts.records import RunFacts
from .scene import build_disturbed_block, build_layout, build_period, build_task

FIRST_ROUND = 2**30
"""Number of the first round when keys are derived; smaller numbers are generations."""
MODEL = 2**31
"""Number from which the key of a model's basis functions is derived."""
BREEDING = 2**31 + 1
"""Number from which the keys of children of chosen creatures derive; no generation has it."""


@dataclass(frozen=True)
class Context:
    """The facts from which the parts of a search are built."""

    chosen: spec.Evolution
    plan: Plan
    """The plan without parts."""
    steps: Programs
    facts: RunFacts
    initial: Sequence[Mapping[str, Any]]
    """Files of initial creatures; none for a run that goes on from its own file."""
    jitted: Callable[..., Any]
    """Compile a program that is short beside simulations."""


def build_parts(context: Context) -> tuple[Part, ...]:
    """Build the parts that the spec asks for, in the order of `PARTS`."""
    built = (build(context) for build in PARTS)
    return tuple(part for part in built if part is not None)


def build_lessons(context: Context) -> Part | None:
    """Build the lessons of emitters whose offspring learn before evaluation."""
    chosen, plan = context.chosen, context.plan
    task = build_task(chosen.scene, room=context.facts.encoding.room)
    descriptors = tuple(axis.name for axis in chosen.archive.descriptors)

    def taught(emitter_spec: spec.Emitter, emitter: search.Emitter) -> lessons.Lessons | None:
        if not isinstance(emitter, emitters.Learner):
            return None
        segment = getattr(emitter_spec, "segment", None)
        slopes = search.block_program(
            lambda one: search.slopes(task, one, descriptors, segment)
        )
        return lessons.Lessons(
            number=emitter.lessons,
            to_differentiate=jax.jit(emitter.to_differentiate),
            # CMA-MEGA asks for one gradient, which costs seven simulations: a padded block
            # would repeat it.
            slopes=Program(slopes, context.facts.block, pads=False),
            learn=jax.jit(emitter.learn),
        )

    built = tuple(map(taught, chosen.emitters, plan.emitters))
    return lessons.part(built) if any(built) else None


def build_initial(context: Context) -> Part | None:
    """Build the initial creatures. Raise `ValueError` if some of their files are missing."""
    names, files = context.chosen.search.initial, context.initial
    if not names:
        return None
    if not files:
        return initial.part(len(names))
    genes = genes_of(context.chosen, files_of(context.chosen, files))
    genotypes = [genomes.read(genome, context.facts.encoding) for genome in genes]
    return initial.part(len(names), breeding.rows_of(list(names), genotypes))


def files_of(
    chosen: spec.Evolution, files: Sequence[Mapping[str, Any]]
) -> list[Mapping[str, Any]]:
    """Return the files of the initial creatures. Raise `ValueError` if one is missing or has
    other genes than its name says."""
    given = {file["sha256"]: file for file in map(creature.parse, files)}
    if missing := [name for name in chosen.search.initial if name not in given]:
        raise ValueError(
            f"`search.initial` needs the file of each creature; got none of {missing[0]}"
        )
    return [given[name] for name in chosen.search.initial]


def terms_of(
    chosen: spec.Spec, files: Sequence[Mapping[str, Any]], data: bytes | None
) -> export.Terms:
    """Return the licence and credit of what a run goes on from, or begins from.

    `data` is its archive file, if there is one, and `files` are those of its initial creatures.
    """
    known = export.terms(file.load(data, only=())[1]) if data else {}
    given = {one["sha256"]: one for one in files}
    if isinstance(chosen, spec.Refinement):
        begun = [chosen.creature]
    else:
        names = chosen.search.initial if isinstance(chosen, spec.Evolution) else []
        begun = [given[name] for name in names if name in given]
    return known or export.joint_terms(begun)


def build_screening(context: Context) -> Part | None:
    """Build the screening of offspring."""
    asked = getattr(context.chosen.search, "screening", None)
    if asked is None:
        return None
    plan, describe = context.plan, build_description(context)
    outputs = search.screening.Outputs(
        plan.axes, len(plan.measures), context.chosen.search.feasible
    )
    shapes = jax.eval_shape(describe, plan.genotype)
    regression = search.screening.Regression(
        inputs=len(shapes.inputs),
        outputs=outputs.count,
        key=jax.random.fold_in(plan.key, MODEL),
    )
    times, states = asked.candidates, (None,) * len(plan.emitters)
    wide = tuple(emitters.with_slots(one, times * one.slots) for one in plan.emitters)

    def candidates(elites, counters, generation, number):
        key = jax.random.fold_in(plan.key, FIRST_ROUND + number)
        children, _, counters = emitters.emit(
            wide, states, elites, counters, generation, key=key
        )
        return children, counters

    programs = screening.Programs(
        emit=jax.jit(candidates),
        describe=search.block_program(describe),
        predict=jax.jit(
            lambda described, model, cells: outputs.predict(
                described, regression, model, cells
            ),
            compiler_options=device.compiler_options(),
        ),
        best=jax.jit(search.screening.best, static_argnums=4),
        outputs=outputs.of,
        insert=context.steps.insert,
        overwrite=context.steps.overwrite,
    )
    settings = screening.Settings(asked.rounds, asked.candidates, asked.unscreened, regression)
    return screening.part(settings, programs, plan.batch)


def build_description(context: Context) -> Callable[..., Any]:
    """Build the function that describes one genotype without simulating it."""
    scene, facts = context.chosen.scene, context.facts
    period = build_period(scene.control)
    assert period is not None  # `spec` refuses screening without a periodic timer.
    task = build_task(scene, room=facts.encoding.room)
    layout = build_layout(spec.shape(scene.body), task.start.positions.dtype)
    strokes = search.screening.Strokes(task, layout, period, scene.task.steps)
    return partial(search.screening.describe, strokes, facts.descriptors)


def build_breeding(context: Context) -> Part | None:
    """Build the descent from chosen creatures, if the search allows it."""
    chosen, plan = context.chosen, context.plan
    asked = getattr(chosen.search, "breeding", None)
    if asked is None or spec.breeding_refusal(chosen.model_dump(mode="json")):
        return None

    def by_weight(emitter: search.Emitter) -> search.Emitter:
        selects = isinstance(emitter, emitters.Selecting)
        return replace(emitter, select="curiosity") if selects else emitter

    # `curiosity` multiplies the chances of parents, so it can carry the weight of a choice.
    breeders = tuple(map(by_weight, plan.emitters))

    def bred(parents, counters, generation, emitter):
        key = jax.random.fold_in(plan.key, BREEDING)
        return emitters.emit_chosen(breeders, parents, counters, generation, emitter, key=key)

    settings = breeding.Settings(asked.share, asked.half_life)
    return breeding.part(settings, context.facts, context.jitted(bred))


def build_reevaluation(context: Context) -> Part | None:
    """Build the reevaluation of elites."""
    chosen, plan = context.chosen, context.plan
    asked = chosen.search.reevaluation
    if asked is None:
        return None
    energy = asked.energy and bool(chosen.world.energy)
    spread = Spread(asked.phase, asked.pose, asked.viscosity, energy)
    size = (chosen.world.width, chosen.world.height)
    settings = reevaluation.Settings(asked.every, asked.samples, spread, size)
    evaluate = build_disturbed_block(chosen.scene, context.facts.encoding.room)
    programs = reevaluation.Programs(
        disturb=jax.jit(
            lambda g, s: reevaluation.disturb(settings, plan.key, plan.cell_count, g, s)
        ),
        # In the block of the offspring, whose size is part of the bits.
        evaluate=replace(plan.programs[OFFSPRING], run=evaluate),
        add=jax.jit(reevaluation.add),
        correct=jax.jit(reevaluation.corrected),
        forget=context.jitted(reevaluation.forget),
    )
    return reevaluation.part(settings, programs)


def build_fronts(context: Context) -> Part | None:
    return containers.fronts() if isinstance(context.plan.container, search.Fronts) else None


def build_epochs(context: Context) -> Part | None:
    container = context.plan.container
    if not isinstance(container, search.LearnedAxes):
        return None
    return containers.epochs(container.dimensions)


PARTS: tuple[Callable[[Context], Part | None], ...] = (
    lambda context: records.lineage(context.facts),
    lambda context: records.outcomes(),
    lambda context: records.failures(),
    build_epochs,
    build_lessons,
    build_initial,
    build_screening,
    build_breeding,
    build_reevaluation,
    build_fronts,
    lambda context: records.curves(),
)
"""The parts of a run, in the order in which they act. A part that changes the children of
another stands after it; the curves stand after all parts that evaluate."""
