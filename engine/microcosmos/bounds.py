"""Bounds of numbers that public constructors take; a spec has its own."""

from math import inf, nan
from typing import Any

import numpy as np

from .invalid import InvalidField

LARGEST = float(np.finfo(np.float32).max)
"""Searches compute in single precision, where a larger number is infinite."""


def refuse_beyond(
    least: float | int, most: float | int = inf, *, open: bool = False, **numbers: Any
) -> None:
    """Raise `InvalidField` unless each number lies from `least` to `most`, and is finite in
    single precision.

    With `open`, `least` itself is refused.
    """
    for field, value in numbers.items():
        number = float(value) if is_number(value) else nan
        able = max(least, -LARGEST) <= number <= min(most, LARGEST)
        if not able or (open and number == least):
            needed = f"above {least:g}" if open else f"at least {least:g}"
            if least == -inf:
                needed = "finite"
            needed += f" and at most {most:g}" if most < inf else " in single precision"
            raise InvalidField(field, f"must be {needed}; got {_shown(value)}")


def refuse_uncountable(least: int, most: float | int = inf, **numbers: Any) -> None:
    """Raise `InvalidField` unless each is a whole number from `least` to `most`."""
    for field, value in numbers.items():
        if not is_whole(value) or not least <= value <= most:
            needed = f"at least {least}" if most == inf else f"from {least} to {most}"
            got = _shown(value)
            raise InvalidField(field, f"must be a whole number, {needed}; got {got}")


def is_whole(value: Any) -> bool:
    """Return whether a value is one whole number, of Python or of NumPy, and no truth value."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def is_number(value: Any) -> bool:
    """Return whether a value is one real number, of Python or of any library of arrays."""
    truth = isinstance(value, bool | np.bool_)
    return not truth and hasattr(value, "__float__") and np.ndim(value) == 0


def _shown(value: Any) -> str:
    return str(value) if is_number(value) else repr(value)
