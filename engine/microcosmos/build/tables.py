"""Build gait sweeps and measurements of scaling."""

import json
from collections.abc import Callable
from dataclasses import replace

import jax.numpy as jnp

from .. import bodies, device, filaments, spec, world
from ..archive.report import Row
from ..archive.sperm import sperm
from ..experiments import gaits, scaling
from ..experiments.table_file import TableRun
from ..spec.scaling import SPACING
from .creatures import build_point, build_stroke_block, identity_template
from .scene import build_world


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
        found = [scaling.step_row(scene, start, plan)]
        if nodes <= chosen.all_pairs:
            found.append(scaling.pairs_row(start.positions, scene.box.size, plan))
        return tuple(Row(row) for row in found)

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
    found = sperm(scene, body)
    if found is None:
        raise ValueError(f"`swimmers` must have stiff joints, got {scene.body.builder!r}")
    return found


def _json(chosen: spec.Spec) -> str:
    return json.dumps(chosen.model_dump(mode="json"), sort_keys=True)
