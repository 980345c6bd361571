"""Evaluate a creature again and compare with what its file says was measured."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax

from .. import search
from ..archive import creature
from ..build import build_block
from ..device import device_kind
from .replay import network_of


@dataclass(frozen=True)
class Check:
    """What the file says and what came out; `exact` where every bit of both is the same."""

    recorded: dict[str, float]
    repeated: dict[str, float]
    same_device: bool

    @property
    def exact(self) -> bool:
        return self.recorded == self.repeated


def check(file: Mapping[str, Any]) -> Check:
    """Run the creature through the very program that measured it.

    Raises `creature.CreatureError` for a file that is not sound or holds no measurement.
    """
    file = creature.parse(file)
    if not file["measured"]:
        raise creature.CreatureError("measured", "what was measured, to compare with", None)
    spec = creature.spec_of(file)
    batch = jax.tree.map(lambda x: x[None], network_of(file, spec))
    evaluation = search.evaluate_blocks(build_block(spec), batch, block=spec.search.block)
    values = evaluation.features[0].tolist()
    return Check(
        recorded=file["measured"]["features"],
        repeated=dict(zip(search.FEATURES, values, strict=True)),
        same_device=file["measured"]["device"] == device_kind(),
    )
