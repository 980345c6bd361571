"""Check the arguments of methods: lists, whole numbers, names and ends, refused by field."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ..bounds import is_number, is_whole
from ..invalid import InvalidField

DIGEST = re.compile("[0-9a-f]{64}")


def several(field: str, values: Any) -> list[Any]:
    """Return a list or another iterable as a list; raise `InvalidField` for a text, whose
    letters would count, and for anything else."""
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise InvalidField(field, f"must be a list; got {values!r:.80}")
    return list(values)


def whole(field: str, value: Any) -> int:
    """Return a number of at least 1, also one of NumPy."""
    if not is_whole(value) or value < 1:
        raise InvalidField(field, f"must be a whole number of at least 1; got {value!r:.80}")
    return int(value)


def seconds(field: str, value: Any) -> float:
    """Return a duration, also an infinite one."""
    if not is_number(value) or not value >= 0:  # A comparison with NaN is false.
        raise InvalidField(field, f"must be a number of at least 0; got {value!r:.80}")
    return float(value)


def wholes(field: str, values: Any) -> list[int]:
    """Return a list of whole numbers."""
    listed = several(field, values)
    if not all(map(is_whole, listed)):
        raise InvalidField(field, f"must be whole numbers; got {listed!r:.80}")
    return [int(one) for one in listed]


def names(field: str, creatures: Any) -> list[str]:
    """Return the names of creatures, given by them or by themselves."""
    return [name(field, getattr(one, "sha", one)) for one in several(field, creatures)]


def name(field: str, sha: Any) -> str:
    """Return the name of a creature."""
    if not isinstance(sha, str) or not DIGEST.fullmatch(sha):
        needed = "must be the 64 hexadecimal digits of a creature's SHA-256"
        raise InvalidField(field, f"{needed}; got {sha!r:.80}")
    return sha


def ends(field: str, given: Any) -> list[float]:
    """Return the low and high end of a region along an axis."""
    plain = isinstance(given, Sequence | np.ndarray) and not isinstance(given, str | bytes)
    numbers: list[Any] = list(given) if plain else []
    if len(numbers) != 2 or not all(is_number(x) and math.isfinite(x) for x in numbers):
        raise InvalidField(
            field, f"must be two finite numbers, low and high; got {given!r:.80}"
        )
    return [float(one) for one in numbers]


def fields(field: str, given: Any) -> dict[str, Any]:
    """Return a mapping of fields."""
    if not isinstance(given, Mapping):
        raise InvalidField(field, f"must be fields by name; got {given!r:.80}")
    return dict(given)
