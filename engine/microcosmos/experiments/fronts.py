"""Figures of Pareto fronts after each generation: in the state, the summary and the file."""

from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Float

from .. import search
from .state import State

NAMES = search.FrontFigures._fields


def measured(state: State) -> State:
    """Return the state with the figures of its fronts, if it has any."""
    if state.fronts is None:
        return state
    assert isinstance(state.container, search.Fronts)
    elites, there = state.elites, np.asarray(state.elites.occupied)
    rows = np.asarray(elites.fitness)[there], np.asarray(elites.measures)[there]
    row = np.array(search.front_figures(*rows, state.container))
    return replace(state, fronts=np.concatenate([state.fronts, row[None]]))


def summary(state: State) -> dict[str, Any]:
    """Return the figures of the last generation; empty without fronts."""
    if state.fronts is None:
        return {}
    return dict(zip(NAMES, state.fronts[-1].tolist(), strict=True))


def columns(state: State) -> dict[str, Any]:
    """Return the group of an archive file; empty without fronts."""
    if state.fronts is None:
        return {}
    return {"fronts": dict(zip(NAMES, state.fronts.T, strict=True))}


def from_columns(tree: dict[str, Any]) -> Float[np.ndarray, "generation figure"] | None:
    """Return the figures of an archive file; None without fronts."""
    if "fronts" not in tree:
        return None
    return np.stack([tree["fronts"][name] for name in NAMES], 1)
