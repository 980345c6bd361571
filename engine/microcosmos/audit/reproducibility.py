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
from ..search import STROKE_MEASURES
from ..spec import Gait
from ..viz.replay import actuator_of


@dataclass(frozen=True)
class Check:
    """Recorded and repeated numbers."""

    fitness: tuple[float, float]
    """Recorded and repeated."""
    recorded: dict[str, float]
    """Measures."""
    repeated: dict[str, float]
    same_device: bool

    @property
    def exact(self) -> bool:
        """Return whether the bits of the fitness and of every recorded measure are the same."""
        known = {name: self.repeated.get(name) for name in self.recorded}
        return self.fitness[0] == self.fitness[1] and self.recorded == known

    @property
    def missing(self) -> list[str]:
        """Return the measures that the evaluation has and the file lacks."""
        return sorted(self.repeated.keys() - self.recorded.keys())


def check(file: Mapping[str, Any]) -> Check:
    """Evaluate the creature by the program that measured it.

    Raises `creature.CreatureError` for a file that is invalid or has no measurement.
    """
    file = creature.parse(file)
    if not file["measured"]:
        raise creature.CreatureError("measured", "a measurement to compare with", None)
    fitness, repeated = _repeat(file)
    return Check(
        fitness=(file["measured"]["fitness"], fitness),
        recorded=file["measured"]["measures"],
        repeated=repeated,
        # `device_kind` names no processor where the portable flags cover a program.
        same_device=file["measured"]["device"] in (device_kind(), device_kind(portable=False)),
    )


def _repeat(file: Mapping[str, Any]) -> tuple[float, dict[str, float]]:
    """Return fitness and measures."""
    scene, block = creature.scene_of(file), file["measured"]["block"]
    if isinstance(scene.control, Gait):
        program, given, names = build_stroke_block(scene), build_point(scene), STROKE_MEASURES
    else:
        given, names = actuator_of(file, scene), measures_of(scene)
        program = build_block(scene)
    # In a block of the recorded size: the size of a program's batch may change its bits.
    found = search.evaluate_blocks(program, _batch_of_one(given), block=block)
    return float(found.fitness[0]), dict(zip(names, found.measures[0].tolist(), strict=True))


def _batch_of_one(item: Any) -> Any:
    return jax.tree.map(lambda x: np.asarray(x)[None], item)


def measurement(file: Mapping[str, Any]) -> dict[str, Any]:
    """Return the comparison as JSON, described in `docs/formats.md`; raises as `check`."""
    file = creature.parse(file)
    checked = check(file)
    return {
        "creature": file["sha256"],
        "exact": checked.exact,
        "device": device_kind(),
        "recorded_device": file["measured"]["device"],
        "fitness": _compared("fitness", *checked.fitness),
        "figures": differing(checked.recorded, checked.repeated),
        "missing": checked.missing,
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
