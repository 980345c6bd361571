"""Reports of generations: figures of the archive and of the search."""

from typing import Any

import numpy as np

from .. import search
from ..archive.report import Elite, Report
from ..archive.variety import variety
from ..search.emitters.population import Population
from ..search.emitters.tensorneat import TensorNeatState
from . import epochs, fronts, screening
from .state import CURVES, ENDS, Plan, State

VARIETY = ("motion_distance", "nearest_motion", "kinds")
"""Figures of `Variety` in the summary of the last generation."""


def figures(state: State) -> tuple[float, ...]:
    """Return the first columns of `CURVES`, summed in double precision."""
    of_cells = search.best_of_cells(state.elites, state.container)
    fitness = of_cells[np.isfinite(of_cells)]
    best, mean = (fitness.max(), fitness.mean()) if len(fitness) else (0.0, 0.0)
    coverage = len(fitness) / len(of_cells)
    return fitness.sum(), coverage, best, mean, state.evaluations, state.infeasible


def report(
    state: State, elites: tuple[Elite, ...], lost: tuple[int, ...], summary: dict[str, Any]
) -> Report:
    values = dict(zip(CURVES, state.curves[-1].tolist(), strict=True))
    return Report(
        generation=state.generation,
        qd_score=values["qd_score"],
        coverage=values["coverage"],
        best=values["best"],
        mean=values["mean"],
        evaluations=state.evaluations,
        infeasible=state.infeasible,
        elites=elites,
        emptied=lost,
        summary=summary,
    )


def summary(plan: Plan, state: State, seconds: float, status: np.ndarray) -> dict[str, Any]:
    """Return figures of the last generation beside the columns that every search has."""
    values = dict(zip(CURVES, state.curves[-1].tolist(), strict=True))
    found: dict[str, Any] = {"device_seconds": seconds, "clipped": int(values["clipped"])}
    for i, name in enumerate(plan.names):
        children, inserted, improved = state.outcomes[-1, i].tolist()
        if plan.bandit:
            found[f"{name}: children"] = children
        found |= {f"{name}: inserted": inserted, f"{name}: improved": improved}
    for name in ("corrected_qd_score", "corrected_coverage", "hit_rate"):
        if np.isfinite(values[name]):
            found[name] = values[name]
    counts = np.bincount(status, minlength=len(search.STATUSES)).tolist()
    named = list(zip(search.STATUSES, counts, strict=True))[1:]
    found |= {f"infeasible: {reason}": count for reason, count in named if count}
    found |= epochs.summary(state.epochs, state.generation)
    found |= _species(state) | fronts.summary(state)
    if state.screened is not None:
        found |= screening.summary(state.screened)
    if state.ended or state.generation >= plan.generations:
        found |= _variety(state)
    if state.ended:
        found["ended"] = f"{ENDS[state.ended]} after generation {state.generation}"
    return found


def _variety(state: State) -> dict[str, float | int]:
    """Return motion distances of the elites; about a second for 512."""
    if len(state.poses) < 2:
        return {}
    fitness = np.asarray(state.elites.fitness)
    cells = sorted(state.poses, key=lambda cell: (-fitness[cell], cell))
    found = variety([state.poses[cell] for cell in cells])
    return {name: getattr(found, name) for name in VARIETY}


def _species(state: State) -> dict[str, str]:
    for emitter in state.emitters:
        if isinstance(emitter, Population | TensorNeatState):
            pairs = emitter.sizes().items()
            return {"species": " ".join(f"{number}:{members}" for number, members in pairs)}
    return {}
