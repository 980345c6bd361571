"""Lengths and times as people write them, quantities as they are shown, and known fluids."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import log10
from typing import Self

from ..invalid import InvalidField

FLUIDS = {
    "acetone": 0.39e-6,
    "water": 1.00e-6,
    "ethanol": 1.5e-6,
    "air": 15.1e-6,
    "olive oil": 92e-6,
    "glycerol": 1120e-6,
    "honey": 7000e-6,
}
"""Kinematic viscosities at 20 °C, in m²/s: viscosity over density. Of liquids but oil and honey
and of air: CRC Handbook of Chemistry and Physics. Olive oil 84 mPa s and 0.913 g/cm³, honey
about 10 Pa s and 1.42 g/cm³: typical values, which vary by a factor of two."""

LIKE = 1.5
"""Largest ratio of two viscosities that are called alike."""

PREFIXES = {"km": 1e3, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6}
PREFIXES |= {"nm": 1e-9}
TIMES = {"min": 60.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6}
SMALLEST, LARGEST = 1e-12, 1e6
"""Limits in m and s; powers of quantities beyond them overflow."""
NUMBER = re.compile(r"\s*([0-9.]+(?:e[+-]?[0-9]+)?)\s*([^\W\d]+)\s*")
PREFIXED = ("m", "s", "m/s")
"""Units that are shown with a prefix."""
SHOWN = ((1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


@dataclass(frozen=True)
class Real:
    """The real length of a body in metres, and the real period of its stroke in seconds."""

    length: float
    period: float

    @classmethod
    def of(cls, length: str | None, period: str | None) -> Self | None:
        """Return the real quantities, such as `1mm` and `0.5s`; None without any.

        Raises `ValueError` where one is missing, or has no known unit.
        """
        if length is None and period is None:
            return None
        if length is None or period is None:
            given, value = ("period", period) if length is None else ("length", length)
            other = "length" if given == "period" else "period"
            raise InvalidField(other, f"must be given too, got `{given}` {value!r} alone")
        return cls(length_of(length), period_of(period))


def length_of(text: str) -> float:
    """Return a length such as `1mm` in metres. Raise `ValueError` for any other text."""
    return _quantity("length", text, PREFIXES, "1mm or 50um", "m")


def period_of(text: str) -> float:
    """Return a time such as `0.5s` in seconds. Raise `ValueError` for any other text."""
    return _quantity("period", text, TIMES, "0.5s or 20ms", "s")


def _quantity(field: str, text: str, known: Mapping[str, float], such: str, si: str) -> float:
    match = NUMBER.fullmatch(text)
    if match and match[2] in known:
        try:
            value = float(match[1]) * known[match[2]]
        # The pattern takes 1.2.3 too, which is no number.
        except ValueError:
            value = 0.0
        if SMALLEST <= value <= LARGEST:
            return value
    raise InvalidField(
        field,
        f"must be a number above 0 with a unit, such as {such}, between "
        f"{SMALLEST:g} and {LARGEST:g} {si}; got {text!r}",
    )


def like(viscosity: float) -> str:
    """Say which fluid has a kinematic viscosity in m²/s, or between which two it lies."""
    names = sorted(FLUIDS, key=FLUIDS.__getitem__)
    # By ratios: viscosities of fluids span four powers of ten.
    nearest = min(names, key=lambda name: abs(log10(FLUIDS[name] / viscosity)))
    ratio = viscosity / FLUIDS[nearest]
    if 1 / LIKE <= ratio <= LIKE:
        return f"as {nearest}"
    above = [name for name in names if FLUIDS[name] > viscosity]
    if not above:
        return f"{ratio:,.3g} times that of {names[-1]}"
    if len(above) == len(names):
        return f"less than common liquids: that of {names[0]} is {1 / ratio:,.3g} times as high"
    return f"between {names[names.index(above[0]) - 1]} and {above[0]}"


def shown(value: float, unit: str) -> str:
    """Format a quantity, with a prefix where its unit takes one, such as `270 µm/s`.

    A prefix counts before the power of a unit: a nm³ is 1e-27 m³.
    """
    if unit not in PREFIXED:
        return f"{value:.3g} {unit}"
    size = abs(value)
    # With three digits, 999.6 mm would be written 1e+03 mm.
    scale, prefix = next(((s, p) for s, p in SHOWN if size >= 0.9995 * s), SHOWN[-1])
    return f"{value / scale:.3g} {prefix}{unit}" if value else f"0 {unit}"


def square(viscosity: float) -> str:
    """Format a kinematic viscosity in m²/s as mm²/s."""
    return f"{viscosity * 1e6:.3g} mm²/s"
