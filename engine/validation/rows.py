"""What one comparison says: a quantity, what it should be and by whom, and what it is here."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Row:
    """One line of the table; it passes where `here` lies between `low` and `high`."""

    quantity: str
    here: float
    low: float
    high: float
    bar: str
    reference: float | None
    source: str
    note: str = ""
    """Why a bar is missed, as far as it is known, or how the number came about."""

    @property
    def passed(self) -> bool:
        return math.isfinite(self.here) and self.low <= self.here <= self.high


def at_most(quantity: str, here: float, bar: float, source: str, note: str = "") -> Row:
    """An error, whose reference is zero."""
    return Row(quantity, float(here), 0.0, bar, f"≤ {bar:g}", 0.0, source, note)


def at_least(
    quantity: str, here: float, bar: float, reference: float, source: str, note: str = ""
) -> Row:
    """A number that only has to be large enough."""
    return Row(quantity, float(here), bar, math.inf, f"≥ {bar:g}", reference, source, note)


def close(
    quantity: str, here: float, reference: float, share: float, source: str, note: str = ""
) -> Row:
    """A number within a share of a published or exact one."""
    reach = abs(reference) * share
    low, high = reference - reach, reference + reach
    bar = f"± {100 * share:g} %"
    return Row(quantity, float(here), low, high, bar, float(reference), source, note)


def between(
    quantity: str,
    here: float,
    low: float,
    high: float,
    reference: float,
    source: str,
    note: str = "",
) -> Row:
    """A number within bounds that are not even around the reference."""
    bar = f"{low:g} to {high:g}"
    return Row(quantity, float(here), low, high, bar, float(reference), source, note)


def holds(quantity: str, fact: bool, source: str, note: str = "") -> Row:
    """Something that is so or not, as 1 or 0."""
    return Row(quantity, float(fact), 1.0, 1.0, "yes", 1.0, source, note)


@dataclass(frozen=True)
class Line:
    """Points of a plot, joined or not."""

    name: str
    x: Sequence[float] | np.ndarray
    y: Sequence[float] | np.ndarray
    style: str = "-"


@dataclass(frozen=True)
class Plot:
    """A figure of the document; an image (x, y) is drawn with lines over it."""

    name: str
    x: str
    y: str
    lines: tuple[Line, ...] = ()
    image: np.ndarray | None = None
    logarithmic: str = ""
    """Which of the axes x and y are."""


@dataclass(frozen=True)
class Found:
    """What a check brings to the document."""

    rows: list[Row]
    plots: list[Plot] = field(default_factory=list)

    @property
    def missed(self) -> list[Row]:
        return [row for row in self.rows if not row.passed]
