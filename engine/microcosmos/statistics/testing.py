"""Rank tests by SciPy, and Holm's correction."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

EXACT = 8
"""With no more runs in one of the groups, p of two groups is exact."""


@dataclass(frozen=True)
class Test:
    """The result of a rank test."""

    name: str
    statistic: float
    p: float


def mann_whitney(ours: np.ndarray, theirs: np.ndarray) -> Test:
    """Return the two-sided test of two groups.

    Mann and Whitney, Ann. Math. Stat. 18, 50 (1947). The statistic is U of the first. p is
    exact for small groups, else by the normal approximation with corrections for continuity
    and ties.
    """
    ranks = stats.rankdata(np.concatenate([ours, theirs]))
    if np.ptp(ranks) == 0:
        return Test("Mann–Whitney", len(ours) * len(theirs) / 2, 1.0)  # All values are equal.
    small, tied = min(len(ours), len(theirs)) <= EXACT, len(np.unique(ranks)) < len(ranks)
    method = "exact" if small and not tied else "asymptotic"
    found = stats.mannwhitneyu(ours, theirs, alternative="two-sided", method=method)
    if not (small and tied):
        return Test(f"Mann–Whitney, {method}", float(found.statistic), float(found.pvalue))
    p = _exact(ranks, len(ours))
    return Test("Mann–Whitney, exact with ties", float(found.statistic), p)


def _exact(ranks: np.ndarray, first: int) -> float:
    """Return the two-sided p of the sum of the `first` ranks, which may be tied.

    It is twice the smaller tail over all ways to choose as many of the ranks. The shift
    algorithm counts them: Streitberg and Röhmel, Statistical Software Newsletter 12, 10 (1986).
    """
    doubled = np.rint(2 * ranks).astype(int)  # Mean ranks of ties are halves.
    chosen = doubled[:first] if 2 * first <= len(ranks) else doubled[first:]
    most = np.sort(doubled)[-len(chosen) :].sum()
    ways = np.zeros((len(chosen) + 1, most + 1))  # By the number of ranks and their sum.
    ways[0, 0] = 1
    for rank in doubled:
        ways[1:, rank:] += ways[:-1, :-rank]  # NumPy copies operands that overlap.
    counts, total = ways[-1], chosen.sum()
    tail = min(counts[: total + 1].sum(), counts[total:].sum())
    return float(min(1.0, 2 * tail / counts.sum()))


def kruskal_wallis(groups: Sequence[np.ndarray]) -> Test:
    """Return the test of several groups.

    Kruskal and Wallis, J. Am. Stat. Assoc. 47, 583 (1952). The statistic is H, corrected for
    ties; p is that of χ².
    """
    ranks = stats.rankdata(np.concatenate(groups))
    if np.ptp(ranks) == 0:
        return Test("Kruskal–Wallis", 0.0, 1.0)  # All values are equal.
    ends = np.cumsum([len(one) for one in groups])[:-1]
    found = stats.kruskal(*np.split(ranks, ends))  # Ranks, since values may be infinite.
    return Test("Kruskal–Wallis", float(found.statistic), float(found.pvalue))


def holm(p: Sequence[float]) -> list[float]:
    """Return p values corrected for their number (Holm, Scand. J. Stat. 6, 65, 1979)."""
    order, corrected, largest = np.argsort(p, kind="stable"), np.zeros(len(p)), 0.0
    for rank, test in enumerate(order):
        largest = max(largest, min(1.0, (len(p) - rank) * p[test]))
        corrected[test] = largest
    return corrected.tolist()
