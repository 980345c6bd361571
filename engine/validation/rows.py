"""Rows and plots of the validation document."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Row:
    """One line of the table; it passes if `value` lies between `low` and `high`."""

    quantity: str
    value: float
    low: float
    high: float
    bar: str
    reference: float | None
    source: str

    @property
    def passed(self) -> bool:
        # A lower bound has no upper one, so that infinity would pass.
        return math.isfinite(self.value) and self.low <= self.value <= self.high


def at_most(quantity: str, value: float, bar: float, source: str) -> Row:
    """Return the row of an error, whose reference is zero."""
    return Row(quantity, float(value), 0.0, bar, f"≤ {bar:g}", 0.0, source)


def at_least(quantity: str, value: float, bar: float, reference: float, source: str) -> Row:
    """Return the row of a number with a lower bound."""
    return Row(quantity, float(value), bar, math.inf, f"≥ {bar:g}", reference, source)


def close(quantity: str, value: float, reference: float, share: float, source: str) -> Row:
    """Return the row of a number within a share of a published or exact one."""
    reach, bar = abs(reference) * share, f"± {100 * share:g} %"
    low, high = reference - reach, reference + reach
    return Row(quantity, float(value), low, high, bar, float(reference), source)


def holds(quantity: str, fact: bool, source: str) -> Row:
    """Return the row of a statement: 1 if it is true, else 0."""
    return Row(quantity, float(fact), 1.0, 1.0, "yes", 1.0, source)


@dataclass(frozen=True)
class Line:
    """Points of a plot."""

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
    """Logarithmic axes: x, y or xy."""


@dataclass(frozen=True)
class Result:
    """The rows and plots of a check on one path."""

    rows: list[Row]
    plots: list[Plot] = field(default_factory=list)

    @property
    def failed(self) -> list[Row]:
        return [row for row in self.rows if not row.passed]


@dataclass(frozen=True)
class Pair:
    """One quantity on both paths; `kernel` is None where only JAX has it."""

    jax: Row
    kernel: Row | None = None

    @property
    def rows(self) -> dict[str, Row]:
        """The rows by the names of their paths."""
        return {"JAX": self.jax} | ({} if self.kernel is None else {"kernel": self.kernel})

    @property
    def passed(self) -> bool:
        return all(row.passed for row in self.rows.values())


@dataclass(frozen=True)
class Findings:
    """The results of a section: a pair of rows for each line, and the plots of JAX."""

    pairs: list[Pair]
    plots: list[Plot] = field(default_factory=list)


def paired(results: Sequence[Result]) -> Findings:
    """Pair the rows of a check in JAX with those in the kernel, if it ran there."""
    jax, *others = results
    if not others:
        return Findings([Pair(row) for row in jax.rows], jax.plots)
    rows = zip(jax.rows, others[0].rows, strict=True)
    return Findings([Pair(one, other) for one, other in rows], jax.plots)
