"""Build a refinement experiment."""

import json

import jax
import numpy as np

from .. import device, genomes, search, spec
from ..archive import creature
from ..experiments import refinement
from ..spec.refinement import parsed
from .cells import build_cells
from .creatures import build_block, identity_template
from .plugins import measures_of, plugin_versions
from .scene import build_task


def build_refinement(chosen: spec.Refinement) -> refinement.Refinement:
    """Build a refinement, whose programs are compiled on first use."""
    found = parsed(chosen.creature)
    scene, room = creature.scene_of(found), creature.room(found)
    measures = {**scene.plugins, **chosen.archive.plugins}
    scene = scene.model_copy(update={"plugins": measures})
    task = build_task(scene, room=room)
    names = tuple(axis.name for axis in chosen.archive.descriptors)
    assert task.encoding is not None
    genotype = genomes.read(found["identity"]["genome"], task.encoding)
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
        parent=found["sha256"],
        provenance=found["provenance"],
        device=device.device_kind(portable=False),
        feasible=chosen.feasible,
        measures=measures_of(scene),
        plugins=plugin_versions(scene),
    )
