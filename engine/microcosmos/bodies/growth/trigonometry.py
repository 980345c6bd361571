"""Sine and cosine in single precision, with the same bits in NumPy and JAX."""

from typing import Any

import numpy as np

QUARTER = 1.5703125, 4.8375129699707031e-4, 7.54978995489188216e-8
"""A quarter turn in three parts, of which small multiples are exact (Cody and Waite)."""


def sine(x: Any, xp: Any) -> Any:
    """Return the sine of angles of a few turns, in rad."""
    return _of_quarter(x, 0, xp)


def cosine(x: Any, xp: Any) -> Any:
    """Return the cosine of angles of a few turns, in rad."""
    return _of_quarter(x, 1, xp)


def _of_quarter(x: Any, ahead: int, xp: Any) -> Any:
    """Return the sine of angles `ahead` by quarter turns, by the polynomials of Cephes."""
    one = x.dtype.type if xp is np else (lambda number: xp.asarray(number, x.dtype))
    quarters = xp.round(x * one(0.63661977))
    near = x
    for part in QUARTER:
        near = near - quarters * one(part)
    z = near * near
    s = (one(-1.9515295891e-4) * z + one(8.3321608736e-3)) * z - one(1.6666654611e-1)
    s = s * z * near + near
    c = (one(2.443315711809948e-5) * z - one(1.388731625493765e-3)) * z
    c = (c + one(4.166664568298827e-2)) * z * z - one(0.5) * z + one(1)
    quarter = quarters.astype(np.int32) + ahead
    found = xp.where(quarter % 2 == 1, c, s)
    return xp.where(quarter % 4 >= 2, -found, found)
