"""Build a folding experiment."""

import json
from functools import partial

import numpy as np

from .. import device, fields, search, spec
from ..experiments import folding
from ..spec import targets
from .creatures import identity_template
from .scene import build_task

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
