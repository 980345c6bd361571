"""Measures of a run: a curve at its end or at evaluations, or its way to a value."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .records import RunRecord

TITLES = {
    "qd_score": "QD score",
    "corrected_qd_score": "corrected QD score",
    "corrected_coverage": "corrected coverage",
    "coverage": "coverage",
    "best": "best fitness",
    "mean": "mean fitness",
    "hit_rate": "hit rate",
}
REEVALUATED = ("corrected_qd_score", "corrected_coverage", "hit_rate")
"""Curves with values only where elites were evaluated again."""

OF_ELITES = ("best", "mean")
"""Curves without a value while the archive is empty. Files then have 0, as for a creature that
does not move, which beats every negative fitness."""
SUMS = ("qd_score", "corrected_qd_score")
"""Curves that add up fitness."""

DEFAULT = ("qd_score", "coverage", "best")
FORM = re.compile(
    r"(?P<curve>[a-z_][a-z0-9_]*)"
    r"(?:@(?P<at>\d[\d,_]*)|>=(?P<reaches>-?\d*\.?\d+(?:e[+-]?\d+)?))?"
)


@dataclass(frozen=True)
class Measure:
    """A number of each run: the last value of a curve; its value `at` a number of evaluations,
    of the last generation that ended by then; or the evaluations until it `reaches` a value."""

    curve: str
    at: int | None = None
    reaches: float | None = None

    @classmethod
    def parse(cls, text: str) -> "Measure":
        """Return the measure of `qd_score`, `qd_score@6400` or `best>=0.5`."""
        found = FORM.fullmatch(text.strip())
        if not found:
            raise ValueError(
                "a measure must be a curve (qd_score), a curve at a number of evaluations "
                f"(qd_score@6400) or on its way to a value (best>=0.5), got {text!r}"
            )
        curve, at, reaches = found.groups()
        if curve == "evaluations" and not at:
            raise ValueError(
                "a measure must be a result, got `evaluations`; evaluations to a value are "
                "written as best>=0.5"
            )
        number = int(re.sub("[,_]", "", at)) if at else None
        return cls(curve, number, float(reaches) if reaches else None)

    @property
    def text(self) -> str:
        """The measure as it is written on the command line."""
        if self.at is not None:
            return f"{self.curve}@{self.at}"
        return self.curve if self.reaches is None else f"{self.curve}>={self.reaches:g}"

    @property
    def title(self) -> str:
        name = TITLES.get(self.curve, self.curve.replace("_", " "))
        if self.at is not None:
            return f"{name} after {self.at:,} evaluations"
        return name if self.reaches is None else f"evaluations to {name} {self.reaches:g}"

    @property
    def less_is_better(self) -> bool:
        return self.reaches is not None

    def of(self, run: RunRecord) -> float:
        """Return the value; infinity where a run does not reach it, minus infinity for the best
        or mean fitness of an archive without elites.

        Raises `ValueError` for a curve that the run lacks, or a point beyond its end.
        """
        curve, evaluations = self._curve(run), run.evaluations
        if self.reaches is not None:
            there = np.flatnonzero(curve >= self.reaches)
            return float(evaluations[there[0]]) if len(there) else np.inf
        until = len(curve) if self.at is None else self._until(run)
        values = curve[:until]
        if self.curve in REEVALUATED and self.at is not None:
            values = values[np.isfinite(values)]
        if not len(values) or np.isnan(values[-1]):
            raise ValueError(
                f"{run.name}: `{self.text}` needs elites that were evaluated again by then "
                "(`search.reevaluation`), got none"
            )
        return float(values[-1])

    def _curve(self, run: RunRecord) -> np.ndarray:
        if self.curve not in run.curves:
            known = ", ".join(sorted(run.curves))
            raise ValueError(f"{run.name}: a curve must be one of {known}, got {self.curve!r}")
        return values_of(run.curves, self.curve)

    def _until(self, run: RunRecord) -> int:
        """Return the number of generations that ended by `at`."""
        assert self.at is not None
        first, last = int(run.evaluations[0]), int(run.evaluations[-1])
        if not first <= self.at <= last:
            raise ValueError(
                f"{run.name}: `{self.text}` needs evaluations from {first:,}, its first "
                f"generation, to {last:,}, its last, got {self.at:,}"
            )
        return int(np.searchsorted(run.evaluations, self.at, side="right"))


def values_of(curves: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Return a curve of a run; best and mean fitness without elites are minus infinity."""
    values = np.asarray(curves[name], np.float64)
    if name in OF_ELITES and "coverage" in curves:
        return np.where(np.asarray(curves["coverage"]) > 0, values, -np.inf)
    return values


def has_negative_fitness(run: RunRecord) -> bool:
    """Return whether the best or mean fitness or the QD score is ever below 0."""
    curves = [run.curves[name] for name in (*OF_ELITES, "qd_score") if name in run.curves]
    return any(bool(np.any(np.asarray(one) < 0)) for one in curves)
