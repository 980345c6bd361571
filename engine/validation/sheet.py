"""Taylor's swimming sheet: a transverse wave that travels along a sheet drives it.

To fourth order in the amplitude, without inertia: G. I. Taylor, Proc. R. Soc. A 209, 447
(1951). Inertia lowers the second order: E. O. Tuck, J. Fluid Mech. 31, 305 (1968).
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import coupling, fluid

from . import immersed
from .rows import Line, Plot, Result, at_least, holds

SOURCE = "Taylor 1951, Tuck 1968"


@dataclass(frozen=True)
class Sheet:
    """One wavelength across the box, far from its images above and below."""

    wavelength: int
    height: int
    amplitude: float
    viscosity: float = 1.0
    inertia: float = 0.4
    """R = ω / (ν k²), by which Tuck measures inertia."""

    @property
    def wavenumber(self) -> float:
        return 2 * np.pi / self.wavelength

    @property
    def frequency(self) -> float:
        """Radians a step."""
        return self.inertia * self.viscosity * self.wavenumber**2


def theory(sheet: Sheet) -> float:
    """Speed against the wave and the fluid far away, in cells a step."""
    steep = (sheet.wavenumber * sheet.amplitude) ** 2
    taylor = 0.5 * sheet.frequency / sheet.wavenumber * steep * (1 - 19 / 16 * steep)
    grown = np.sqrt((1 + np.sqrt(1 + sheet.inertia**2)) / 2)
    return taylor * 0.5 * (1 + 1 / grown)


def speed(sheet: Sheet, periods: int, kernel: coupling.Kernel = coupling.ROMA) -> float:
    """Measure the speed of a force-free sheet of nodes over the last period.

    The wave is prescribed in the sheet's own frame. To make the sheet free of force, the
    projection subtracts a velocity from the nodes, which moves the sheet.
    """
    dtype, nodes = jnp.dtype("float32"), sheet.wavelength
    period = round(2 * np.pi / sheet.frequency)
    rates = fluid.rates(jnp.asarray(sheet.viscosity, dtype), fluid.fixed_magic)
    along = jnp.arange(nodes, dtype=dtype)
    middle = jnp.asarray([0.0, sheet.height // 2], dtype)
    options = {
        "surroundings": fluid.Surroundings(),
        "projection": coupling.force_free,
        "kernel": kernel,
    }

    def shape(time):
        turn = 2 * jnp.pi * (along / nodes - time / period)
        return jnp.stack([along, sheet.amplitude * jnp.sin(turn)], 1)

    def step(carry, time):
        f, place = carry
        here = shape(time)
        wanted = shape(time + 1) - here
        f, velocity, _ = immersed.step(f, here + place[None], wanted, rates, **options)
        moved = jnp.mean(velocity - wanted, 0)
        far = jnp.mean(fluid.momentum(f)[0][:, 0])
        return (f, place + moved), far - moved[0]

    still = tuple(jnp.zeros((sheet.wavelength, sheet.height), dtype) for _ in range(9))
    times = jnp.arange(periods * period) % period
    program = jax.jit(lambda carry: jax.lax.scan(step, carry, times.astype(dtype)))
    _, speeds = program((still, middle))
    return float(np.mean(np.asarray(speeds[-period:], float)))


SHEETS = (Sheet(32, 64, 1.0), Sheet(64, 128, 2.0), Sheet(128, 256, 4.0))
BARS = {32: 0.65, 64: 0.83, 128: 0.92}


def check(sheets: tuple[Sheet, ...] = SHEETS, periods: int = 2) -> Result:
    """Check that the error, caused by the delta's thickness, falls with the wavelength."""
    ratios = [speed(sheet, periods) / theory(sheet) for sheet in sheets]
    lengths = [sheet.wavelength for sheet in sheets]
    what = "swimming sheet, wavelength {}: speed over theory"
    rows = [
        at_least(what.format(n), ratio, BARS[n], 1.0, SOURCE)
        for n, ratio in zip(lengths, ratios, strict=True)
    ]
    rises = ratios == sorted(ratios)
    rows.append(holds("the sheet's speed rises with the wavelength", rises, SOURCE))
    lines = (Line("here", lengths, ratios, "o-"), Line("theory", lengths, [1.0] * len(ratios)))
    plot = Plot("sheet", "wavelength in cells", "speed / theory", lines, None, "x")
    return Result(rows, [plot])
