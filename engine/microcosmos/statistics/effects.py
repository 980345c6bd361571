"""Quartiles, effect sizes and means of the middle half, with bootstrap intervals of SciPy."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

LEVEL = 0.95
CHUNK = 1_000_000
"""Numbers that the bootstrap holds at a time."""


@dataclass(frozen=True)
class Bootstrap:
    """Resamples of a percentile bootstrap, and the seed of its generator."""

    resamples: int = 9999
    seed: int = 0

    def interval(
        self, samples: Sequence[np.ndarray], statistic: Callable[..., np.ndarray]
    ) -> tuple[float, float]:
        """Return the 95 % interval of a statistic of independent samples.

        Each sample is drawn again by itself, which is the stratified bootstrap where samples
        are tasks (Agarwal et al. 2021). `statistic` takes the samples and `axis`. An end is
        not finite where resamples beyond it have infinite statistics.
        """
        size = max(1, np.prod([len(one) for one in samples], dtype=float))
        with np.errstate(invalid="ignore"):  # SciPy subtracts infinite statistics.
            found = stats.bootstrap(
                tuple(samples),
                statistic,
                paired=False,
                vectorized=True,
                n_resamples=self.resamples,
                batch=int(max(1, min(self.resamples, CHUNK // min(size, CHUNK)))),
                confidence_level=LEVEL,
                method="percentile",
                rng=np.random.default_rng(self.seed),
            )
        return float(found.confidence_interval.low), float(found.confidence_interval.high)


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
    return stats.trim_mean(np.concatenate(samples, axis=axis), 0.25, axis=axis)


def quartiles(values: np.ndarray) -> tuple[float, float, float]:
    """Return lower quartile, median and upper quartile, by linear interpolation.

    Infinite values, of runs that never reach a score, count as greater than all others, and
    minus infinity, of archives without elites, as less.
    """
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
