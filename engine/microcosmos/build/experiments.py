"""Build the experiment of a spec."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial, singledispatch
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import bodies, device, fields, filaments, genomes, neat, search, spec, world
from ..archive import creature
from ..archive.initial import counters, genes_of
from ..archive.report import Row
from ..experiments import Experiment, folding, gaits, refinement, scaling
from ..experiments.evolution import Evolution
from ..experiments.table_file import TableRun
from ..measures import NAMED
from ..quantities.bodies import sperm
from ..quantities.scales import stroke_of
from ..search import emitters
from ..search.loop import Limits, Plan, Program, Programs
from ..search.parts.records import RunFacts
from ..spec import targets
from ..spec.refinement import parsed
from ..spec.scaling import SPACING
from .parts import Context, build_parts, files_of
from .plan import build_cells, build_container, build_emitters, operators_of
from .plugins import measures_of, plugin_versions
from .scene import (
    build_block,
    build_encoding,
    build_point,
    build_stroke_block,
    build_task,
    build_world,
    identity_template,
)

DENSITIES = {"saturated": fields.saturated, "raw": fields.unsaturated}


def build_folding(chosen: spec.Folding) -> folding.Folding:
    """Build a folding, whose program is compiled on first use."""
    descent = build_descent(chosen)
    return folding.Folding(
        spec=json.dumps(chosen.model_dump(mode="json"), sort_keys=True),
        names=tuple(target.name for target in chosen.targets),
        start=search.folding.start(descent, build_pictures(chosen)),
        program=search.block_program(partial(search.folding.update, descent)),
        updates=chosen.updates,
        block=chosen.block,
        identity_template=identity_template(chosen.scene),
        device=device.device_kind(portable=False),
    )


def build_descent(chosen: spec.Folding) -> search.folding.Descent:
    """Build the settings of an update."""
    return search.folding.Descent(
        task=build_task(chosen.scene),
        width=chosen.width,
        density=DENSITIES[chosen.density],
        rate=chosen.rate,
        segment=chosen.segment,
    )


def build_pictures(chosen: spec.Folding) -> np.ndarray:
    """Build the pictures on the lattice, (fold, x, y)."""
    size = (chosen.world.width, chosen.world.height)
    return np.stack([targets.field(one.ink, size, chosen.size) for one in chosen.targets])


def build_refinement(chosen: spec.Refinement) -> refinement.Refinement:
    """Build a refinement, whose programs are compiled on first use."""
    file = parsed(chosen.creature)
    scene, room = creature.scene_of(file), creature.room(file)
    named = {*scene.measures, *chosen.archive.named}
    scene = scene.model_copy(
        update={
            "measures": tuple(name for name in NAMED if name in named),
            "plugins": {**scene.plugins, **chosen.archive.plugins},
        }
    )
    task = build_task(scene, room=room)
    names = tuple(axis.name for axis in chosen.archive.descriptors)
    assert task.encoding is not None
    genotype = genomes.read(file["identity"]["genome"], task.encoding)
    return refinement.Refinement(
        spec=json.dumps(chosen.model_dump(mode="json"), sort_keys=True),
        genotype=jax.tree.map(lambda x: np.asarray(x)[None], genotype),
        slopes=search.block_program(
            lambda one: search.slopes(task, one, names, chosen.segment)
        ),
        evaluate_block=build_block(scene, room),
        cells=build_cells(chosen.archive, measures_of(scene)),
        names=names,
        steps=chosen.steps,
        length=chosen.length,
        block=chosen.block,
        identity_template=identity_template(scene),
        encoding=task.encoding,
        parent=file["sha256"],
        provenance=file["provenance"],
        device=device.device_kind(portable=False),
        feasible=chosen.feasible,
        measures=measures_of(scene),
        plugins=plugin_versions(scene),
    )


def build_gaits(chosen: spec.Gaits) -> TableRun:
    """Build a gait sweep, whose programs are compiled on first use."""
    strokes, kind = build_strokes(chosen), device.device_kind(portable=False)

    def rows(number: int, stop: Callable[[], bool]) -> tuple[Row, ...]:
        return gaits.stroke_rows(strokes[number], stop, block=chosen.block, device=kind)

    return TableRun(_json(chosen), kind, len(strokes), rows, gaits.report)


def build_strokes(chosen: spec.Gaits) -> tuple[gaits.Stroke, ...]:
    return tuple(_stroke(chosen, form, swimmer) for form, swimmer in chosen.strokes)


def build_scaling(chosen: spec.Scaling) -> TableRun:
    """Build a measurement of wall time."""

    def rows(number: int, stop: Callable[[], bool]) -> tuple[Row, ...]:
        nodes = chosen.nodes[number]
        plan = scaling.Timing(chosen.steps, chosen.part_steps, device.compiler_options(), stop)
        scene, start = build_crowd(chosen, nodes)
        measured = [scaling.step_row(scene, start, plan)]
        if nodes <= chosen.all_pairs:
            measured.append(scaling.pairs_row(start.positions, scene.box.size, plan))
        return tuple(Row(row) for row in measured)

    kind = device.device_kind(portable=False)
    return TableRun(_json(chosen), kind, len(chosen.nodes), rows, scaling.report)


def build_crowd(chosen: spec.Scaling, nodes: int) -> tuple[scaling.Scene, world.State]:
    """Build a box with many straight filaments at random places, at rest."""
    one = bodies.chain(chosen.filament, SPACING)
    centres = chosen.centres(nodes).tolist()
    crowd = bodies.combined([bodies.placed(one, centre) for centre in centres])
    wide = spec.World(width=chosen.width, height=chosen.height, steric=chosen.steric)
    # Swept at every size: a layout of many nodes has no room.
    box = replace(build_world(wide, spec.Coupling(), crowd), layout=None)
    start = world.at_rest(box, jnp.asarray(crowd.positions, jnp.float32))
    rest = filaments.Rest(
        jnp.asarray(crowd.rest_angle, jnp.float32), jnp.asarray(crowd.rest_length, jnp.float32)
    )
    return scaling.Scene(box, rest), start


def _stroke(chosen: spec.Gaits, form: str, swimmer: str) -> gaits.Stroke:
    scenes = [chosen.scene(form, swimmer, viscosity) for viscosity in chosen.viscosities]
    body = spec.shape(scenes[0].body)
    spacing = float(body.rest_length.max())
    return gaits.Stroke(
        form=form,
        swimmer=swimmer,
        force_free=scenes[0].coupling.force_free,
        program=build_stroke_block(scenes[0]),
        conditions=gaits.stack([build_point(scene) for scene in scenes]),
        viscosities=chosen.viscosities,
        sperm=tuple(_sperm(scene, body) for scene in scenes),
        spacing=spacing,
        identities=tuple(identity_template(scene) for scene in scenes),
    )


def _sperm(scene: spec.Scene, body: bodies.Body) -> float:
    number = sperm(scene, body, stroke_of(scene))
    if number is None:
        raise ValueError(f"`swimmers` must have stiff joints, got {scene.body.builder!r}")
    return number


def _json(chosen: spec.Spec) -> str:
    return json.dumps(chosen.model_dump(mode="json"), sort_keys=True)


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
    facts = build_facts(chosen)
    measures = measures_of(chosen.scene)
    container = build_container(chosen.archive, measures)
    sources = build_emitters(chosen, facts.encoding, search.cells_of(container))
    small = container.count * sum(one.slots for one in sources) <= SMALL
    key = jax.random.key(chosen.seed, impl="threefry2x32")
    steps = build_programs(sources, key, small)
    plan = Plan(
        seed=chosen.seed,
        container=container,
        emitters=sources,
        counters=build_counters(chosen, initial),
        genotype=jax.eval_shape(lambda: facts.encoding.newcomer(key=key)),
        measures=measures,
        steps=steps,
        evaluate=Program(
            build_block(chosen.scene, facts.encoding.room),
            facts.block,
            after=search.judged if chosen.search.feasible else lambda found: found,
        ),
        names=names_of(chosen.emitters),
        generations=chosen.search.generations,
        limits=build_stop_limits(chosen.search.stop),
    )
    context = Context(chosen, plan, steps, facts, initial, compiler(small))
    return Evolution(replace(plan, parts=build_parts(context)), facts)


def build_programs(
    sources: tuple[search.Emitter, ...], key: jax.Array, small: bool
) -> Programs:
    """Build the steps of a generation; each is compiled for this run's sizes and seed."""
    jitted = compiler(small)
    options = quick(small)
    insert = search.insert_program(options)

    def emit(states, elites, counters, generation):
        return emitters.emit(sources, states, elites, counters, generation, key=key)

    # Programs of their own: fused into one they would round differently, and no archive would
    # have the bytes of before.
    return Programs(
        emission=jitted(emit),
        insert=insert,
        overwrite=insert if small else search.insert_program(options, donate=True),
        credit=jitted(emitters.credit),
        tell=jitted(lambda states, outcome: emitters.tell(sources, states, outcome)),
    )


def quick(small: bool) -> dict[str, object]:
    """Return the compiler options of the programs of a search; a small one compiles quickly."""
    # The bits are the same: tests/engine/experiments/test_quick_programs.py.
    return device.quick_options() if small else {}


def compiler(small: bool) -> Callable[..., Any]:
    """Return the compiler of the programs of a search."""
    return partial(jax.jit, compiler_options=quick(small))


def build_facts(chosen: spec.Evolution) -> RunFacts:
    """Build the facts that all creatures of a run share."""
    scene = chosen.scene
    return RunFacts(
        spec=json.dumps(chosen.model_dump(mode="json"), sort_keys=True),
        identity_template=identity_template(scene),
        encoding=build_encoding(scene, room_of(chosen)),
        block=chosen.search.block,
        descriptors=tuple(axis.name for axis in chosen.archive.descriptors),
        device=device.device_kind(portable=is_portable(chosen)),
        plugins=plugin_versions(scene),
        force_free=chosen.coupling.force_free,
        operators=operators_of(chosen),
    )


def build_counters(
    chosen: spec.Evolution, initial: Sequence[Mapping[str, Any]] = ()
) -> neat.Counters:
    """Build the first numbers that no gene of a newcomer or an initial creature has."""
    first = neat.first_counters(len(chosen.control.inputs), len(chosen.control.outputs))
    if not initial or build_encoding(chosen.scene, room_of(chosen)).room is None:
        return first
    genes = genes_of(chosen, files_of(chosen, initial))
    # New genes get numbers that no ancestor has, or crossover would align what only looks
    # alike.
    pairs = zip(vars(first).items(), counters(genes), strict=True)
    return neat.Counters(**{name: jnp.maximum(own, used) for (name, own), used in pairs})


def is_portable(chosen: spec.Evolution) -> bool:
    """Return whether a search uses nothing that may sum differently on another processor:
    derivatives, named measures, plug-ins or other libraries."""
    # A measure in JAX sums as XLA likes on a processor; the kernel's measures do not.
    foreign = chosen.scene.measures or any(spec.plugins_in(chosen.model_dump(mode="json")))
    return all(emitter.is_portable for emitter in chosen.emitters) and not foreign


def build_stop_limits(stop: spec.Stop) -> Limits:
    given = {name: value for name, value in stop.model_dump().items() if value is not None}
    return Limits(**given)


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
