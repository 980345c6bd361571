"""Checks of what a search of your own is given, and descriptions of its parts."""

from dataclasses import fields
from typing import Any

import numpy as np

from .emitters import Emitter, Learner
from .emitters.tensorneat import TensorNeat
from .spaces import Numbers


def refuse_unfit(emitters: tuple[Emitter, ...]) -> None:
    """Raise `ValueError` without emitters, or for those that `Search` cannot run."""
    if not emitters:
        raise ValueError("`emitters` must hold at least one, got none")
    for emitter in emitters:
        if isinstance(emitter, Learner | TensorNeat):
            raise ValueError(
                "`emitters` must do without derivatives and loops of other libraries, got "
                f"{type(emitter).__name__}"
            )


def checked(name: str, given: Numbers, kind: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return an array of a kind. Raises `ValueError` for another shape."""
    found = np.asarray(given)
    if found.shape != shape:
        raise ValueError(f"`{name}` must have shape {shape}, got {found.shape}")
    with np.errstate(over="ignore"):  # Beyond single precision a number is not finite.
        return found.astype(kind)


def described(part: Any) -> list[Any]:
    """Return the name of a part's class, and its fields that are words, numbers or arrays of
    numbers."""
    found = [getattr(part, field.name) for field in fields(part)]
    plain = (int, float, str, list, tuple, np.ndarray)
    numbers = [np.asarray(one).tolist() for one in found if isinstance(one, plain)]
    return [type(part).__name__, *numbers]
