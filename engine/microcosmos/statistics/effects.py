"""Rank tests, Holm's correction, effect sizes and means with bootstrap intervals, by SciPy."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # Loads `stats`, half a second of every start, when it is first used.

from ..invalid import InvalidField

LEVEL = 0.95
MAX_RESAMPLES = 1_000_000
CHUNK = 1_000_000
"""Numbers that the bootstrap holds at a time."""


@dataclass(frozen=True)
class Bootstrap:
    """Resamples of a percentile bootstrap, and the seed of its generator."""

    resamples: int = 9999
    seed: int = 0

    def __post_init__(self):
        for name, least in (("resamples", 1), ("seed", 0)):
            if (got := getattr(self, name)) < least:
                raise InvalidField(name, f"must be at least {least}; got {got}", least=least)

    def interval(
        self,
        samples: Sequence[np.ndarray],
        statistic: Callable[..., np.ndarray],
        pairs: int = 0,
    ) -> tuple[float, float]:
        """Return the 95 % interval of a statistic of independent samples.

        Each sample is drawn again by itself, which is the stratified bootstrap where samples
        are tasks (Agarwal et al. 2021). `statistic` takes the samples and `axis`; `pairs` is
        the most pairs of values that it holds at a time. An end is not finite where resamples
        beyond it have infinite statistics.
        """
        size = max(1, pairs, sum(map(len, samples)))
        with np.errstate(invalid="ignore"):  # SciPy subtracts infinite statistics.
            bootstrap = scipy.stats.bootstrap(
                tuple(samples),
                statistic,
                paired=False,
                vectorized=True,
                n_resamples=self.resamples,
                batch=max(1, min(self.resamples, CHUNK // size)),
                confidence_level=LEVEL,
                method="percentile",
                # A generator for each interval: the order of measures changes none of them.
                rng=np.random.default_rng(self.seed),
            )
        interval = bootstrap.confidence_interval
        return float(interval.low), float(interval.high)


def superiority(ours: np.ndarray, theirs: np.ndarray, axis: int = -1) -> Any:
    """Return A12, the share of pairs in which ours is greater, ties half.

    Vargha and Delaney, J. Educ. Behav. Stat. 25, 101 (2000), equation 14 without ranks.
    """
    ours, theirs = np.moveaxis(ours, axis, -1), np.moveaxis(theirs, axis, -1)
    first, second = ours[..., :, None], theirs[..., None, :]
    return ((first > second) + 0.5 * (first == second)).mean((-2, -1))


def middle_mean(*samples: np.ndarray, axis: int = -1) -> Any:
    """Return the mean of the middle half of all samples together, as rliable's IQM does.

    A quarter of the values, rounded down, is left out at either end.
    """
    return scipy.stats.trim_mean(np.concatenate(samples, axis=axis), 0.25, axis=axis)


def quartiles(values: np.ndarray) -> tuple[float, float, float]:
    """Return lower quartile, median and upper quartile, by linear interpolation.

    Infinite values, of runs that never reach a score, count as greater than all others, and
    minus infinity, of archives without elites, as less.
    """
    # NumPy's quantiles are NaN between infinite values.
    ordered = np.sort(values)
    low, middle, high = (
        _between(ordered, share * (len(values) - 1)) for share in (0.25, 0.5, 0.75)
    )
    return low, middle, high


def _between(ordered: np.ndarray, place: float) -> float:
    below, above = ordered[int(np.floor(place))], ordered[int(np.ceil(place))]
    if below == above or np.isneginf(below):  # Also where both are infinite.
        return float(below)
    return float(below + (above - below) * (place - np.floor(place)))


SMALLER, LARGER = 8, 50
"""Most runs of the smaller of two groups for which p is exact, or of the larger one."""


@dataclass(frozen=True)
class Test:
    """The result of a rank test."""

    name: str
    statistic: float
    p: float


def mann_whitney(ours: np.ndarray, theirs: np.ndarray) -> Test:
    """Return the two-sided test of two groups.

    Mann and Whitney, Ann. Math. Stat. 18, 50 (1947). The statistic is U of the first. p is
    exact where a group has at most 8 runs or both have at most 50, else by the normal
    approximation with corrections for continuity and ties, which misleads where many values
    are equal: Bergmann, Ludbrook and Spooren, Am. Stat. 54, 72 (2000).
    """
    ranks = scipy.stats.rankdata(np.concatenate([ours, theirs]))
    if np.ptp(ranks) == 0:
        return Test("Mann–Whitney", len(ours) * len(theirs) / 2, 1.0)  # All values are equal.
    small = min(len(ours), len(theirs)) <= SMALLER or max(len(ours), len(theirs)) <= LARGER
    tied = len(np.unique(ranks)) < len(ranks)
    method = "exact" if small and not tied else "asymptotic"
    result = scipy.stats.mannwhitneyu(ours, theirs, alternative="two-sided", method=method)
    if not (small and tied):
        return Test(f"Mann–Whitney, {method}", float(result.statistic), float(result.pvalue))
    # SciPy's exact p ignores ties, which small groups often have.
    p = _exact(ranks, len(ours))
    return Test("Mann–Whitney, exact with ties", float(result.statistic), p)


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
    ranks = scipy.stats.rankdata(np.concatenate(groups))
    if np.ptp(ranks) == 0:
        return Test("Kruskal–Wallis", 0.0, 1.0)  # All values are equal.
    ends = np.cumsum([len(one) for one in groups])[:-1]
    result = scipy.stats.kruskal(*np.split(ranks, ends))  # Ranks, since values may be infinite.
    return Test("Kruskal–Wallis", float(result.statistic), float(result.pvalue))


def holm(p: Sequence[float]) -> list[float]:
    """Return p values corrected for their number (Holm, Scand. J. Stat. 6, 65, 1979)."""
    order, corrected, largest = np.argsort(p, kind="stable"), np.zeros(len(p)), 0.0
    for rank, test in enumerate(order):
        # Never below the p before it: the correction keeps the order.
        largest = max(largest, min(1.0, (len(p) - rank) * p[test]))
        corrected[test] = largest
    return corrected.tolist()
