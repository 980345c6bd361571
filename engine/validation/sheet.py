"""Check of Taylor's swimming sheet, which a transverse wave along it drives.

To fourth order in the amplitude, without inertia: G. I. Taylor, Proc. R. Soc. A 209, 447
(1951). Inertia lowers the second order: E. O. Tuck, J. Fluid Mech. 31, 305 (1968).
"""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, coupling, filaments, fluid, world

from . import scenes
from .paths import JAX, Path, roll
from .rows import Line, Plot, Result, at_least, holds

SOURCE = "Taylor 1951, Tuck 1968"


@dataclass(frozen=True)
class Sheet:
    """A sheet of one wavelength across the box, far from its images above and below."""

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
    """Return the speed against the wave and the fluid far away, in cells a step."""
    steep = (sheet.wavenumber * sheet.amplitude) ** 2
    taylor = 0.5 * sheet.frequency / sheet.wavenumber * steep * (1 - 19 / 16 * steep)
    grown = np.sqrt((1 + np.sqrt(1 + sheet.inertia**2)) / 2)
    return taylor * 0.5 * (1 + 1 / grown)


SAMPLES = 8
"""Times in a period at which the fluid far away is measured."""


def speed(sheet: Sheet, periods: int, path: Path = JAX) -> float:
    """Measure the speed of a force-free sheet of nodes over the last period.

    The wave is prescribed in the sheet's own frame. A second sheet above, its mirror image,
    keeps it from turning: both are one body, by an edge between their ends.
    """
    part = round(2 * np.pi / sheet.frequency / SAMPLES)
    nodes = waves(sheet, np.arange(periods * SAMPLES * part + 1) / (SAMPLES * part))
    box, state = _pair(sheet, nodes[0])
    angle, length = shapes_of(nodes[1:])
    seen = [_seen(sheet, box, state)]
    for sample in range(periods * SAMPLES):
        steps = slice(sample * part, (sample + 1) * part)
        rest = filaments.Rest(*(jnp.asarray(x[steps], "float32") for x in (angle, length)))
        state, _ = roll(path, box, state, rest)
        seen.append(_seen(sheet, box, state))
    place, far = np.transpose(seen[-1 - SAMPLES :])
    return float(np.mean(far[1:]) - (place[-1] - place[0]) / (SAMPLES * part))


def _pair(sheet: Sheet, nodes: np.ndarray) -> tuple[world.World, world.State]:
    """Return a world with a filament through the nodes of both sheets, and its first state."""
    number = np.arange(len(nodes))
    body = bodies.from_edges(nodes, np.stack([number[:-1], number[1:]], 1))
    form = world.Form(
        projection=coupling.force_free, forcing_iterations=5, magic=fluid.fixed_magic
    )
    size = (sheet.wavelength, 2 * sheet.height)
    box, _ = scenes.immersed(body, sheet.viscosity, "float32", size=size, form=form)
    return box, world.at_rest(box, jnp.asarray(nodes, "float32"))


def _seen(sheet: Sheet, box: world.World, state: world.State) -> tuple[float, float]:
    """Return the body's place along x, and the fluid's velocity halfway between the sheets."""
    momentum = np.asarray(fluid.momentum(state.populations)[0], float)
    place = np.mean(scenes.unwrapped(box, state.positions, state.boxes)[:, 0])
    return float(place), float(np.mean(momentum[:, [0, sheet.height]]))


def waves(sheet: Sheet, periods: np.ndarray) -> np.ndarray:
    """Return the nodes of both sheets after times in periods, (time, node, 2)."""
    along = np.arange(sheet.wavelength)
    height = sheet.amplitude * np.sin(2 * np.pi * (along / sheet.wavelength - periods[:, None]))
    low = np.stack([np.broadcast_to(along, height.shape), 0.5 * sheet.height + height], 2)
    return np.concatenate([low, (low * [1, -1] + [0, 2 * sheet.height])[:, ::-1]], 1)


def shapes_of(nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the rest angles and rest lengths of a filament through nodes, time first."""
    v = np.diff(nodes, axis=1)
    turn = np.diff(np.arctan2(v[..., 1], v[..., 0]), axis=1)
    return turn - 2 * np.pi * np.round(turn / (2 * np.pi)), np.hypot(v[..., 0], v[..., 1])


SHEETS = (Sheet(32, 64, 1.0), Sheet(64, 128, 2.0), Sheet(128, 256, 4.0))
BARS = {32: 0.65, 64: 0.83, 128: 0.92}


def check(sheets: tuple[Sheet, ...] = SHEETS, periods: int = 2, path: Path = JAX) -> Result:
    """Check that the error, caused by the delta's thickness, falls with the wavelength."""
    ratios = [speed(sheet, periods, path) / theory(sheet) for sheet in sheets]
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
