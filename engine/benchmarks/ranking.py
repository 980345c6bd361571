"""Medians, quartiles and rank tests of figures of several seeds."""

import numpy as np
from scipy.stats import mannwhitneyu


def ranks(ours: np.ndarray, theirs: np.ndarray) -> tuple[float, float]:
    """Return the share of pairs in which ours is greater, ties half, and p of a two-sided test
    (Mann and Whitney)."""
    found = mannwhitneyu(ours, theirs, alternative="two-sided")
    return float(found.statistic) / (len(ours) * len(theirs)), float(found.pvalue)


def holm(p: list[float]) -> list[float]:
    """Return p values corrected for the number of tests (Holm, Scand. J. Stat. 6, 65, 1979)."""
    order, corrected, largest = np.argsort(p), np.zeros(len(p)), 0.0
    for rank, test in enumerate(order):
        largest = max(largest, min(1.0, (len(p) - rank) * p[test]))
        corrected[test] = largest
    return corrected.tolist()


def quartiles(values: np.ndarray) -> str:
    low, middle, high = np.percentile(values, (25, 50, 75))
    return f"{middle:.2f} ({low:.2f}–{high:.2f})"
