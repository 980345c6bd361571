"""Evaluate a creature again and compare with the measurement in its file."""

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
from ..spec.creature import fitness_of
from ..viz.replay import actuator_of


@dataclass(frozen=True)
class Check:
    """Recorded and repeated measures; `exact` if every recorded bit is the same."""

    recorded: dict[str, float]
    repeated: dict[str, float]
    same_device: bool

    @property
    def exact(self) -> bool:
        return self.recorded == {name: self.repeated.get(name) for name in self.recorded}


def check(file: Mapping[str, Any]) -> Check:
    """Evaluate the creature by the program that measured it.

    Raises `creature.CreatureError` for a file that is invalid or has no measurement.
    """
    file = creature.parse(file)
    if not file["measured"]:
        raise creature.CreatureError("measured", "a measurement to compare with", None)
    repeated = _repeat(file)
    return Check(
        recorded=file["measured"]["measures"],
        repeated=repeated,
        same_device=file["measured"]["device"] in (device_kind(), device_kind(portable=False)),
    )


def _repeat(file: Mapping[str, Any]) -> dict[str, float]:
    scene, block = creature.scene_of(file), file["measured"]["block"]
    if isinstance(scene.control, Gait):
        program, point = build_stroke_block(scene), build_point(scene)
        found = search.evaluate_blocks(program, _batch_of_one(point), block=block)
        return dict(zip(search.STROKE_MEASURES, found.measures[0].tolist(), strict=True))
    genotype = actuator_of(file, scene)
    found = search.evaluate_blocks(build_block(scene), _batch_of_one(genotype), block=block)
    return dict(zip(measures_of(scene), found.measures[0].tolist(), strict=True))


def _batch_of_one(item: Any) -> Any:
    return jax.tree.map(lambda x: np.asarray(x)[None], item)


def measurement(file: Mapping[str, Any]) -> dict[str, Any]:
    """Return the comparison as JSON, described in `docs/formats.md`; raises as `check`."""
    file = creature.parse(file)
    found = check(file)
    fitness = file["measured"]["fitness"]
    task = creature.Identity.model_validate(file["identity"]).task
    # Compilers may fuse the sum in fitness: equal measures mean equal fitness.
    repeated = fitness if found.exact else fitness_of(task, found.repeated)
    return {
        "creature": file["sha256"],
        "exact": found.exact,
        "device": device_kind(),
        "recorded_device": file["measured"]["device"],
        "fitness": _compared("fitness", fitness, repeated),
        "figures": differing(found.recorded, found.repeated),
    }


def differing(recorded: Mapping[str, float], repeated: Mapping[str, float]) -> list[Any]:
    """Return the measures that differ, largest relative difference first."""
    both = {name: (value, repeated.get(name, np.nan)) for name, value in recorded.items()}
    wrong = [name for name, (value, other) in both.items() if value != other]
    wrong.sort(key=lambda name: (-_relative_difference(*both[name]), name))
    return [_compared(name, *both[name]) for name in wrong]


def _relative_difference(recorded: float, repeated: float) -> float:
    if not np.isfinite(repeated):
        return np.inf
    return abs(repeated - recorded) / max(abs(recorded), 1e-30)


def _compared(name: str, recorded: float, repeated: float) -> dict[str, Any]:
    finite = float(repeated) if np.isfinite(repeated) else None
    return {"name": name, "recorded": float(recorded), "measured": finite}
