"""Trials along the slope of fitness, at several lengths."""

from dataclasses import dataclass

import numpy as np

SHRINK = 4.0
"""A trial is so much shorter than the one before."""


@dataclass(frozen=True)
class Trials:
    """Genes to be tried, and how far each is from where they began."""

    genes: np.ndarray
    """(trial, gene)."""
    lengths: np.ndarray
    """(trial,)."""
    slope: float | None = None
    """Length of the slope of fitness; None where nothing is tried but the start itself."""

    def health(self, before: float, fitness: np.ndarray) -> dict[str, float | None]:
        """How far the gradient can be trusted: `agreement` is what the shortest trial along it
        gained for each unit of what the slope foretold."""
        if not self.slope:
            return {"slope": self.slope, "agreement": None}
        shortest = 2 * ((len(self.lengths) - 1) // 2)
        foretold = self.lengths[shortest] * self.slope
        agreement = (float(fitness[shortest]) - before) / foretold
        return {"slope": self.slope, "agreement": agreement if np.isfinite(agreement) else None}


def start(genes: np.ndarray) -> Trials:
    """Nothing but where it begins."""
    return Trials(genes[None], np.zeros(1))


def along(genes: np.ndarray, rows: np.ndarray, length: float, count: int) -> Trials:
    """By turns along the slope of fitness, the first of `rows`, and along what is left of it
    once its part in the span of the others, those of descriptors, is taken out."""
    fitness, descriptors = rows[0], rows[1:]
    ways = np.stack([_unit(fitness), _unit(_without(fitness, descriptors))])
    lengths = length / SHRINK ** np.arange((count + 1) // 2)
    trials = genes[None, None] + lengths[:, None, None] * ways[None]
    trials = trials.reshape(-1, len(genes))[:count].astype(genes.dtype)
    return Trials(trials, np.repeat(lengths, 2)[:count], float(np.linalg.norm(fitness)))


def _without(row: np.ndarray, others: np.ndarray) -> np.ndarray:
    others = others[np.abs(others).sum(1) > 0]
    if not len(others):
        return row
    _, sizes, basis = np.linalg.svd(others, full_matrices=False)
    basis = basis[sizes > 1e-6 * sizes[0]]
    return row - basis.T @ (basis @ row)


def _unit(row: np.ndarray) -> np.ndarray:
    return row / max(float(np.linalg.norm(row)), 1e-30)
