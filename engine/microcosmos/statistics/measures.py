"""Measures of a run: a curve at its end or at evaluations, or its way to a value."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..archive.curves import CORRECTED, SHARES, curve_title
from ..invalid import InvalidField
from ..spec.paths import number_text
from .records import RunRecord

OF_ELITES = ("best", "mean")
"""Curves without a value while the archive is empty. Files then have 0, as for a creature that
does not move, which beats every negative fitness."""

DEFAULT = ("qd_score", "coverage", "best")
FORM = re.compile(
    r"(?P<curve>[a-z_][a-z0-9_]*)"
    r"(?:@(?P<at>\d[\d,_]*)|>=(?P<reaches>-?\d*\.?\d+(?:e[+-]?\d+)?))?"
)


@dataclass(frozen=True)
class Measure:
    """A number of each run: the last value of a curve; its value `at` a number of evaluations,
    of the last generation that ended by then; or the evaluations until it `reaches` a value.

    Evaluations are those of `RunRecord.searched`."""

    curve: str
    at: int | None = None
    reaches: float | None = None

    @classmethod
    def parse(cls, text: str) -> "Measure":
        """Return the measure of `qd_score`, `qd_score@6400` or `best>=0.5`."""
        matched = FORM.fullmatch(text.strip())
        if not matched:
            raise InvalidField(
                "measure",
                "needs a curve (qd_score), a curve at a number of evaluations "
                f"(qd_score@6400) or on its way to a value (best>=0.5), got {text!r}",
            )
        curve, at, reaches = matched.groups()
        if curve == "evaluations" and not at:
            raise InvalidField(
                "measure",
                "needs a result, got `evaluations`; evaluations to a value are "
                "written as best>=0.5",
            )
        if reaches:
            _refuse_value(curve, float(reaches), text)
        number = int(re.sub("[,_]", "", at)) if at else None
        return cls(curve, number, float(reaches) if reaches else None)

    @property
    def text(self) -> str:
        """Return the measure as the command line has it."""
        if self.at is not None:
            return f"{self.curve}@{self.at}"
        return (
            self.curve if self.reaches is None else f"{self.curve}>={number_text(self.reaches)}"
        )

    @property
    def title(self) -> str:
        name = curve_title(self.curve)
        if self.at is not None:
            return f"{name} after {self.at:,} evaluations"
        if self.reaches is None:
            return name
        return f"evaluations to {name} {number_text(self.reaches)}"

    @property
    def less_is_better(self) -> bool:
        return self.reaches is not None

    def of(self, run: RunRecord) -> float:
        """Return the value of a run.

        It is infinity if the run does not reach the value, and minus infinity for the best or
        mean fitness of an archive without elites. Raises `ValueError` for a curve that the run
        lacks, or a point beyond its end.
        """
        curve = self._curve(run)
        if self.reaches is None:
            return float(curve[self._shown(run)])
        if np.isnan(curve).all():
            raise self._needs_number(run)
        reached = np.flatnonzero(curve >= self.reaches)
        return float(run.searched[reached[0]]) if len(reached) else np.inf

    def since(self, run: RunRecord) -> float:
        """Return the evaluations up to the generation whose value `of` returns."""
        return float(run.searched[self._shown(run)])

    def is_fresh(self, run: RunRecord) -> bool:
        """Return whether the curve has a number of the last generation that ended by `at`."""
        return bool(np.isfinite(self._curve(run)[self._until(run) - 1]))

    def moments(self, run: RunRecord) -> np.ndarray:
        """Return the evaluations up to each generation in which the curve has a number."""
        return run.searched[~np.isnan(self._curve(run))]

    def _shown(self, run: RunRecord) -> int:
        """Return the index of the generation whose value counts."""
        curve = self._curve(run)
        place = len(curve) - 1 if self.at is None else self._until(run) - 1
        if self.curve in CORRECTED and self.at is not None:
            # Elites are evaluated again every few generations; the others have NaN.
            known = np.flatnonzero(np.isfinite(curve[: place + 1]))
            place = known[-1] if len(known) else place
        if np.isnan(curve[place]):
            raise self._needs_number(run)
        return int(place)

    def _needs_number(self, run: RunRecord) -> ValueError:
        again = "elites that were evaluated again by then (`search.reevaluation`), got none"
        needed = again if self.curve in CORRECTED else "a number, got NaN"
        return ValueError(f"{run.name}: `{self.text}` needs {needed}")

    def _curve(self, run: RunRecord) -> np.ndarray:
        if self.curve in CORRECTED and self.curve not in run.curves:
            return np.full(len(run.searched), np.nan)  # The run has no such part.
        if self.curve not in run.curves:
            known = ", ".join(sorted(run.curves))
            raise ValueError(f"{run.name}: a curve must be one of {known}, got {self.curve!r}")
        return values_of(run.curves, self.curve)

    def _until(self, run: RunRecord) -> int:
        """Return the number of generations that ended by `at`."""
        assert self.at is not None
        first, last = int(run.searched[0]), int(run.searched[-1])
        if not first <= self.at <= last:
            raise ValueError(
                f"{run.name}: `{self.text}` needs evaluations{apart([run])} from {first:,}, "
                f"its first generation, to {last:,}, its last, got {self.at:,}"
            )
        # A generation that ends exactly at the number counts.
        return int(np.searchsorted(run.searched, self.at, side="right"))


def parsed(measures: Iterable[Measure | str]) -> list[Measure]:
    """Return measures, each once: one that is named twice must not count twice."""
    read = (Measure.parse(one) if isinstance(one, str) else one for one in measures)
    return list(dict.fromkeys(read))


def _refuse_value(curve: str, value: float, text: str) -> None:
    if not np.isfinite(value):
        raise InvalidField("measure", f"needs a finite value to reach, got {text!r}")
    if curve in SHARES and value > 1:
        raise InvalidField(
            "measure",
            f"needs a share from 0 to 1, since {curve_title(curve)} is one, got {text!r}",
            most=1,
        )


def refuse_other_schedules(runs: Sequence[RunRecord], measure: Measure) -> None:
    """Raise `ValueError` if corrected values are of other moments in some runs than in others.

    A schedule of re-evaluation, or an early end, would order such runs by itself.
    """
    if measure.curve not in CORRECTED:
        return
    if measure.reaches is not None:
        _refuse_other_moments(runs, measure)
    elif measure.at is not None and not all(measure.is_fresh(run) for run in runs):
        # Reversed, so that a message names the first run with each number.
        shown = {measure.since(run): run for run in reversed(runs)}
        if len(shown) > 1:
            low, high = min(shown), max(shown)
            raise InvalidField(
                measure.text,
                f"needs values after equal evaluations{apart(runs)}, got one after {low:,.0f} "
                f"in {shown[low].name} and after {high:,.0f} in {shown[high].name}"
                f"{advice(runs, measure)}",
            )


def _refuse_other_moments(runs: Sequence[RunRecord], measure: Measure) -> None:
    """Raise `ValueError` if a run has a value where another has none, before all have reached
    what they reach."""
    latest = max((x for run in runs if (x := measure.of(run)) < np.inf), default=-np.inf)
    moments = [set(measure.moments(run)[measure.moments(run) <= latest]) for run in runs]
    for run, own in zip(runs, moments, strict=True):
        if differing := own ^ moments[0]:
            at = min(differing)
            has, lacks = (run, runs[0]) if at in own else (runs[0], run)
            raise InvalidField(
                measure.text,
                f"needs values after equal evaluations{apart(runs)}, got one after {at:,.0f} "
                f"in {has.name} and none there in {lacks.name}",
            )


def apart(runs: Sequence[RunRecord]) -> str:
    """Return what numbers of evaluations leave out, for messages."""
    again = any(run.is_reevaluated for run in runs)
    return " (without those of elites again)" if again else ""


def advice(runs: Sequence[RunRecord], measure: Measure) -> str:
    """Return the last point at which all runs may be compared, for messages; empty without."""
    points = {int(min(run.searched[-1] for run in runs))}
    if measure.curve in CORRECTED:
        # Elsewhere, runs would show values of different generations.
        points = set.intersection(*(set(measure.moments(run).astype(int)) for run in runs))
    return f"; compare at {measure.curve}@{max(points)}" if points else ""


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
