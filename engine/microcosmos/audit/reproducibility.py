"""Evaluate a creature again and compare with what its file says was measured."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from .. import search
from ..archive import creature
from ..build import build_block, build_point, build_stroke_block, measures_of
from ..device import device_kind
from ..spec import Gait
from ..viz.replay import actuator_of


@dataclass(frozen=True)
class Check:
    """What the file says and what came out; `exact` where every recorded bit is the same."""

    recorded: dict[str, float]
    repeated: dict[str, float]
    same_device: bool

    @property
    def exact(self) -> bool:
        return self.recorded == {name: self.repeated.get(name) for name in self.recorded}


def check(file: Mapping[str, Any]) -> Check:
    """Run the creature through the very program that measured it.

    Raises `creature.CreatureError` for a file that is not sound or holds no measurement.
    """
    file = creature.parse(file)
    if not file["measured"]:
        raise creature.CreatureError("measured", "what was measured, to compare with", None)
    repeated = _repeat(file)
    return Check(
        recorded=file["measured"]["measures"],
        repeated=repeated,
        same_device=file["measured"]["device"] == device_kind(),
    )


def _repeat(file: Mapping[str, Any]) -> dict[str, float]:
    scene, block = creature.scene_of(file), file["measured"]["block"]
    if isinstance(scene.control, Gait):
        program, point = build_stroke_block(scene), build_point(scene)
        found = search.evaluate_blocks(program, _alone(point), block=block)
        return dict(zip(search.STROKE_MEASURES, found.measures[0].tolist(), strict=True))
    genotype = actuator_of(file, scene)
    found = search.evaluate_blocks(build_block(scene), _alone(genotype), block=block)
    return dict(zip(measures_of(scene), found.measures[0].tolist(), strict=True))


def _alone(item: Any) -> Any:
    return jax.tree.map(lambda x: np.asarray(x)[None], item)
