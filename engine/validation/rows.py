"""Rows and plots of the document, and the precision of a check."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Literal

import jax
import jax.numpy as jnp
import numpy as np

Precision = Literal["float32", "float64"]


@contextmanager
def precision(name: Precision) -> Iterator[Any]:
    """Let JAX compute with numbers of this type, which is yielded."""
    with jax.enable_x64(name == "float64"):
        yield jnp.dtype(name)


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

    @property
    def passed(self) -> bool:
        return math.isfinite(self.here) and self.low <= self.here <= self.high


def at_most(quantity: str, here: float, bar: float, source: str) -> Row:
    """An error, whose reference is zero."""
    return Row(quantity, float(here), 0.0, bar, f"≤ {bar:g}", 0.0, source)


def at_least(quantity: str, here: float, bar: float, reference: float, source: str) -> Row:
    """A number with a lower bound."""
    return Row(quantity, float(here), bar, math.inf, f"≥ {bar:g}", reference, source)


def close(quantity: str, here: float, reference: float, share: float, source: str) -> Row:
    """A number within a share of a published or exact one."""
    reach = abs(reference) * share
    low, high = reference - reach, reference + reach
    bar = f"± {100 * share:g} %"
    return Row(quantity, float(here), low, high, bar, float(reference), source)


def between(
    quantity: str,
    here: float,
    low: float,
    high: float,
    reference: float,
    source: str,
) -> Row:
    """A number within uneven bounds around the reference."""
    bar = f"{low:g} to {high:g}"
    return Row(quantity, float(here), low, high, bar, float(reference), source)


def holds(quantity: str, fact: bool, source: str) -> Row:
    """A fact, as 1 or 0."""
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
class Found:
    """The rows and plots of a check."""

    rows: list[Row]
    plots: list[Plot] = field(default_factory=list)

    @property
    def missed(self) -> list[Row]:
        return [row for row in self.rows if not row.passed]
