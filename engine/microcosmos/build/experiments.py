"""Build the experiment of a spec."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial, singledispatch
from typing import Any

import jax
import jax.numpy as jnp

from .. import device, genomes, neat, search, spec
from ..archive.initial import counters, genes_of
from ..experiments import Experiment, deciding, reevaluation
from ..experiments.evolution import Evolution
from ..experiments.named import Breeding, InitialCreatures, rows_of
from ..experiments.offspring import Lessons, Programs
from ..experiments.state import Limits, Plan, Reevaluation
from ..search.emitters.tensorneat import TensorNeat
from .cells import build_container
from .creatures import build_block, build_disturbed_block, identity_template
from .emitters import (
    build_bandit,
    build_breeding_emission,
    build_emission,
    build_emitters,
)
from .folding import build_folding
from .plugins import measures_of, plugin_versions
from .refinement import build_refinement
from .scene import build_encoding, build_task
from .screening import build_screening, build_screening_programs
from .tables import build_gaits, build_scaling

SMALL = 2**16
"""Cells times offspring with which a search's own programs are short beside simulations."""


@singledispatch
def build(chosen: spec.Spec, initial: Sequence[Mapping[str, Any]] = ()) -> Experiment:
    """Build the experiment of a spec, its programs ready to be compiled.

    `initial` are the creature files that `search.initial` names; a resumed run needs none.
    """
    raise TypeError(f"`spec` must be an experiment's, got {type(chosen).__name__}")


build.register(build_folding)
build.register(build_gaits)
build.register(build_refinement)
build.register(build_scaling)


@build.register
def build_evolution(
    chosen: spec.Evolution, initial: Sequence[Mapping[str, Any]] = ()
) -> Evolution:
    """Build a search with an archive."""
    plan = with_initial(build_plan(chosen), chosen, initial)
    emitters = plan.emitters
    on_host = any(isinstance(emitter, TensorNeat) for emitter in emitters)
    small = plan.cell_count * plan.batch <= SMALL
    options = device.quick_options() if small else {}
    jitted = partial(jax.jit, compiler_options=options)
    compiled = (lambda program: program) if on_host else jitted
    insert = search.insert_program(options)
    # Each program is compiled for this run's sizes and seed.
    programs = Programs(
        emit=compiled(build_emission(plan)),
        evaluate_block=build_block(chosen.scene, room_of(chosen)),
        insert=insert,
        overwrite=insert if small else search.insert_program(options, donate=True),
        credit=jitted(search.emitters.credit),
        tell=compiled(lambda states, outcome: search.emitters.tell(emitters, states, outcome)),
        forget=jitted(search.reevaluation.forget),
        lessons=build_lessons(chosen, emitters),
        screen=build_screening_programs(chosen, plan),
        breed=jitted(build_breeding_emission(plan)) if plan.breeding else None,
    )
    return Evolution(
        plan, programs, build_repeats(chosen, plan), build_deciding(chosen, plan, jitted)
    )


def build_lessons(
    chosen: spec.Evolution, emitters: tuple[search.Emitter, ...]
) -> tuple[Lessons | None, ...]:
    """Build the lessons of each emitter whose offspring learn."""
    pairs = zip(chosen.emitters, emitters, strict=True)
    task = build_task(chosen.scene, room=room_of(chosen))
    descriptors = tuple(axis.name for axis in chosen.archive.descriptors)

    def lessons(emitter_spec: spec.Emitter, emitter: search.Emitter) -> Lessons | None:
        if not isinstance(emitter, search.emitters.Learner):
            return None
        segment = getattr(emitter_spec, "segment", None)
        return Lessons(
            number=emitter.lessons,
            to_differentiate=jax.jit(emitter.to_differentiate),
            slopes=search.block_program(
                lambda one: search.slopes(task, one, descriptors, segment)
            ),
            learn=jax.jit(emitter.learn),
        )

    return tuple(lessons(emitter_spec, emitter) for emitter_spec, emitter in pairs)


def build_repeats(chosen: spec.Evolution, plan: Plan) -> reevaluation.Programs | None:
    """Build the programs that reevaluate elites, if the spec asks for it."""
    settings = plan.reevaluation
    if settings is None:
        return None
    return reevaluation.Programs(
        disturb=jax.jit(
            lambda g, s: reevaluation.disturb(settings, plan.key, plan.cell_count, g, s)
        ),
        evaluate_block=build_disturbed_block(chosen.scene, plan.encoding.room),
        add=jax.jit(search.reevaluation.add),
        correct=jax.jit(search.reevaluation.corrected),
    )


def build_deciding(
    chosen: spec.Evolution, plan: Plan, jitted: Callable[..., Any]
) -> deciding.Programs | None:
    """Build the programs of means that decide, if the spec asks for them."""
    settings = plan.reevaluation
    if settings is None or not plan.decides:
        return None
    return deciding.Programs(
        disturb=jitted(lambda given, s: deciding.disturb(settings, plan.key, given, s)),
        evaluate_block=build_disturbed_block(chosen.scene, plan.encoding.room),
        cells_of=jitted(lambda cells, measures: cells.of(measures)),
    )


def is_portable(chosen: spec.Evolution) -> bool:
    """Return whether a search does without derivatives, plug-ins and other libraries, which may
    sum as a processor likes."""
    foreign = any(
        one.operator == "cma-me" or getattr(one, "backend", "microcosmos") != "microcosmos"
        for one in chosen.emitters
    )
    plugins = plugin_versions(chosen.scene)
    return not (any(chosen.gradients) or foreign or plugins)


def build_plan(chosen: spec.Evolution) -> Plan:
    """Build everything that the experiment needs besides programs."""
    scene = chosen.scene
    encoding = build_encoding(scene, room_of(chosen))
    fixed = len(chosen.control.inputs), len(chosen.control.outputs)
    plan = Plan(
        spec=json.dumps(chosen.model_dump(mode="json"), sort_keys=True),
        identity_template=identity_template(scene),
        seed=chosen.seed,
        generations=chosen.search.generations,
        block=chosen.search.block,
        descriptors=tuple(axis.name for axis in chosen.archive.descriptors),
        container=build_container(chosen.archive, measures_of(scene)),
        encoding=encoding,
        emitters=build_emitters(chosen, encoding),
        names=names_of(chosen.emitters),
        counters=neat.first_counters(*fixed),
        device=device.device_kind(portable=is_portable(chosen)),
        limits=build_stop_limits(chosen.search.stop),
        reevaluation=build_reevaluation(chosen),
        bandit=build_bandit(chosen),
        feasible=chosen.search.feasible,
        force_free=chosen.coupling.force_free,
        measures=measures_of(scene),
        plugins=plugin_versions(scene),
        breeding=build_breeding(chosen),
    )
    return replace(plan, screening=build_screening(chosen, plan))


def with_initial(
    plan: Plan, chosen: spec.Evolution, files: Sequence[Mapping[str, Any]]
) -> Plan:
    """Add initial creatures to the plan of a search, if any are given."""
    if not files:
        return plan
    given = {file["sha256"]: file for file in files}
    if missing := [name for name in chosen.search.initial if name not in given]:
        raise ValueError(
            f"`search.initial` needs the file of each creature; got none of {missing[0]}"
        )
    genes = genes_of(chosen, [given[name] for name in chosen.search.initial])
    genotypes = [genomes.read(genome, plan.encoding) for genome in genes]
    found = InitialCreatures(*rows_of(list(chosen.search.initial), genotypes))
    return replace(plan, initial=found, counters=_counters(plan, genes))


def _counters(plan: Plan, genes: list[dict[str, Any]]) -> neat.Counters:
    if plan.encoding.room is None:
        return plan.counters
    found = zip(vars(plan.counters).items(), counters(genes), strict=True)
    return neat.Counters(**{name: jnp.maximum(first, used) for (name, first), used in found})


def build_stop_limits(stop: spec.Stop) -> Limits:
    given = {name: value for name, value in stop.model_dump().items() if value is not None}
    return Limits(**given)


def build_breeding(chosen: spec.Evolution) -> Breeding | None:
    """Build the settings of descent from chosen creatures, if the search allows it."""
    asked = getattr(chosen.search, "breeding", None)
    if asked is None or spec.breeding_refusal(chosen.model_dump(mode="json")):
        return None
    return Breeding(asked.share, asked.half_life)


def build_reevaluation(chosen: spec.Evolution) -> Reevaluation | None:
    """Build the interval and the conditions of reevaluation."""
    asked = chosen.search.reevaluation
    if asked is None:
        return None
    spread = search.reevaluation.Spread(
        asked.phase, asked.pose, asked.viscosity, asked.energy and bool(chosen.world.energy)
    )
    size = (chosen.world.width, chosen.world.height)
    decides = asked.decides, asked.max_samples, asked.max_error
    return Reevaluation(asked.every, asked.samples, spread, size, *decides)


def names_of(emitters: tuple[spec.Emitter, ...]) -> tuple[str, ...]:
    """Return the operators, numbered where there are several of a kind."""
    kinds = [emitter.operator for emitter in emitters]
    return tuple(
        f"{kind} {kinds[: i + 1].count(kind)}" if kinds.count(kind) > 1 else kind
        for i, kind in enumerate(kinds)
    )


def room_of(chosen: spec.Evolution) -> tuple[int, int]:
    """Return the number of nodes and connections of network arrays."""
    return chosen.genome.max_nodes, chosen.genome.max_connections
