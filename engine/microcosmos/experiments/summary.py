"""What a search tells of a generation beside the columns that every search has."""

from typing import Any

import numpy as np

from .. import search
from .state import ENDS, Plan, State


def summary(
    plan: Plan, state: State, values: dict[str, float], seconds: float, status: np.ndarray
) -> dict[str, Any]:
    """Of the generation that led to a state: its curves' `values`, what its evaluation took,
    and the status of each of its creatures.
    """
    found: dict[str, Any] = {"device_seconds": seconds, "clipped": int(values["clipped"])}
    for i, name in enumerate(plan.names):
        _, inserted, improved = state.outcomes[-1, i].tolist()
        found |= {f"{name}: inserted": inserted, f"{name}: improved": improved}
    for name in ("corrected_qd_score", "corrected_coverage", "hit_rate"):
        if np.isfinite(values[name]):
            found[name] = values[name]
    found |= _divergences(status) | _species(state)
    if state.ended:
        found["ended"] = f"{ENDS[state.ended]} after generation {state.generation}"
    return found


def _divergences(status: np.ndarray) -> dict[str, int]:
    """How many of the creatures do not count, for each reason that there was."""
    counts = np.bincount(status, minlength=len(search.STATUSES)).tolist()
    named = zip(search.STATUSES, counts, strict=True)
    return {f"diverged: {name}": count for name, count in list(named)[1:] if count}


def _species(state: State) -> dict[str, str]:
    """Members of each species, by its number, where a population of its own is divided."""
    for kept in state.emitters:
        if isinstance(kept, search.emitters.Divided):
            pairs = kept.sizes().items()
            return {"species": " ".join(f"{number}:{members}" for number, members in pairs)}
    return {}
