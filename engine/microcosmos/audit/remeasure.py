"""A creature measured again where it has come to, beside what its file says."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..archive import creature
from ..device import device_kind
from ..spec.creature import fitness_of
from .reproducibility import check


def measurement(file: Mapping[str, Any]) -> dict[str, Any]:
    """A JSON document described in `docs/formats.md`.

    Raises `creature.CreatureError` for a file that is not sound or holds no measurement.
    """
    file = creature.parse(file)
    found = check(file)
    fitness = file["measured"]["fitness"]
    task = creature.Identity.model_validate(file["identity"]).task
    # Compilers may fuse the sum that fitness is: figures that are the same settle it.
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
    """The figures that differ, those first that do by the largest share."""
    both = {name: (value, repeated.get(name, np.nan)) for name, value in recorded.items()}
    wrong = [name for name, (value, other) in both.items() if value != other]
    wrong.sort(key=lambda name: (-_share(*both[name]), name))
    return [_compared(name, *both[name]) for name in wrong]


def _share(recorded: float, repeated: float) -> float:
    if not np.isfinite(repeated):
        return np.inf
    return abs(repeated - recorded) / max(abs(recorded), 1e-30)


def _compared(name: str, recorded: float, repeated: float) -> dict[str, Any]:
    finite = float(repeated) if np.isfinite(repeated) else None
    return {"name": name, "recorded": float(recorded), "measured": finite}
