"""Learned axes of a run that has ended, as measures of its elites.

While a run goes on its axes change, and creatures of before would have to be read again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from sqlalchemy.orm import Session

from microcosmos.archive.learned import LearnedAxes, learned_axes

from ..attempts.checkpoints import last_checkpoint
from ..services.services import Services
from ..tables import TERMINAL, Run
from .schemas import Measure

Values = Mapping[str, Sequence[float | None]]


@dataclass(frozen=True)
class LearnedMeasures:
    """The coordinates of elites along learned axes."""

    axes: LearnedAxes
    bins: int

    @property
    def names(self) -> list[str]:
        return [f"learned_{i + 1}" for i in range(len(self.axes.explained))]

    @property
    def described(self) -> list[Measure]:
        """Return the measures; they come before others as axes of a map."""
        parts = zip(self.names, self.axes.explained, self.axes.ends, strict=True)
        return [
            Measure(
                name=name,
                title=f"Learned axis {i + 1} ({100 * share:.0f} % of the variance)",
                unit="",
                low=float(low),
                high=float(high),
                scale="linear",
                bins=self.bins,
            )
            for i, (name, share, (low, high)) in enumerate(parts)
        ]

    def columns(self, values: Values) -> dict[str, list[float]]:
        """Return the coordinates by name, from columns of the measures that make the axes."""
        rows = [[np.nan if x is None else x for x in values[one]] for one in self.axes.measures]
        found = self.axes.places(np.array(rows, float).T)
        return {name: found[:, i].tolist() for i, name in enumerate(self.names)}


def read(session: Session, services: Services, run: Run) -> LearnedMeasures | None:
    """Return the learned axes of a run; None without any, and while it goes on."""
    container = run.spec["archive"].get("container") or {}
    if container.get("kind") != "learned" or run.status not in TERMINAL:
        return None
    last = last_checkpoint(session, run.id)
    if last is None:
        return None
    try:
        found = learned_axes(services.artifacts.read(last.path))
    except ValueError:  # It ended before any axes were learned.
        return None
    return LearnedMeasures(found, container["bins"])


def stored(names: Sequence[str], learned: LearnedMeasures | None) -> list[str]:
    """Return the stored measures that are needed for some measures."""
    if learned is None or not set(names) & set(learned.names):
        return list(names)
    plain = [name for name in names if name not in learned.names]
    return list(dict.fromkeys((*plain, *learned.axes.measures)))
