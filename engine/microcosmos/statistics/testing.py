"""Rank tests by SciPy, and Holm's correction."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

EXACT = 8
"""With no more runs in one of the groups, and without ties, p of two groups is exact."""


@dataclass(frozen=True)
class Test:
    """The result of a rank test."""

    name: str
    statistic: float
    p: float


def mann_whitney(ours: np.ndarray, theirs: np.ndarray) -> Test:
    """Return the two-sided test of two groups.

    Mann and Whitney, Ann. Math. Stat. 18, 50 (1947). The statistic is U of the first. p is
    exact for small groups without ties, else by the normal approximation with corrections for
    continuity and ties.
    """
    together = np.concatenate([ours, theirs])
    tied = len(np.unique(together)) < len(together)
    exact = min(len(ours), len(theirs)) <= EXACT and not tied
    method = "exact" if exact else "asymptotic"
    if np.ptp(stats.rankdata(together)) == 0:
        return Test("Mann–Whitney", len(ours) * len(theirs) / 2, 1.0)  # All values are equal.
    found = stats.mannwhitneyu(ours, theirs, alternative="two-sided", method=method)
    return Test(f"Mann–Whitney, {method}", float(found.statistic), float(found.pvalue))


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
