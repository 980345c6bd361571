"""From the spec of a refinement to the experiment that carries it out."""

import json
from typing import Any

import jax
import numpy as np

from .. import device, search, spec
from ..archive import creature
from ..experiments import refinement
from ..spec.refinement import parsed
from .cells import build_cells
from .creatures import build_block, frame
from .plugins import measures_of, plugin_versions
from .scene import build_task


def build_refinement(chosen: spec.Refinement) -> refinement.Refinement:
    """A refinement, its programs compiled when they are first used."""
    found = parsed(chosen.creature)
    scene, room = _scene(chosen, found), creature.room(found)
    task, names = build_task(scene, room=room), _names(chosen)
    assert task.encoding is not None
    genotype = task.encoding.read(found["identity"]["genome"])
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
        frame=frame(scene),
        encoding=task.encoding,
        parent=found["sha256"],
        provenance=found["provenance"],
        device=device.device_kind(),
        measures=measures_of(scene),
        plugins=plugin_versions(scene),
    )


def _scene(chosen: spec.Refinement, found: dict[str, Any]) -> spec.Scene:
    """The creature's, with what its own archive and this one measure."""
    scene = creature.scene_of(found)
    return scene.model_copy(update={"plugins": {**scene.plugins, **chosen.archive.plugins}})


def _names(chosen: spec.Refinement) -> tuple[str, ...]:
    return tuple(axis.name for axis in chosen.archive.descriptors)
