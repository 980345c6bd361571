"""Held cylinders: the drag of an array in slow flow, and drag and wake in a free stream.

Array: Sangani and Acrivos, Int. J. Multiphase Flow 8, 193 (1982), series in the solid share c.

Drag at Reynolds numbers 20 and 40 in unbounded fluid: Dennis and Chang, J. Fluid Mech. 42, 471
(1970). Drag and Strouhal number at 100: Park, Kwon and Choi, KSME Int. J. 12, 1200 (1998). The
four-point delta makes the cylinder thicker than the circle of its nodes, in slow flow by 1.0
cells at this size; all numbers here use 0.8.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, coupling, fluid, world

from . import scenes
from .paths import JAX, Path, roll
from .rows import Line, Plot, Result, at_most, close, holds

SANGANI = "Sangani and Acrivos 1982"
DENNIS, PARK = "Dennis and Chang 1970", "Park, Kwon and Choi 1998"
DRAG = {20: (2.05, DENNIS), 40: (1.52, DENNIS), 100: (1.33, PARK)}
STROUHAL = {100: (0.165, PARK)}
THICKER = 0.8
"""Cells by which a cylinder is thicker than the circle of its nodes."""


@dataclass(frozen=True)
class Case:
    """A cylinder of `diameter` cells in a periodic box; its sizes are in diameters."""

    reynolds: int
    diameter: int = 16
    length: int = 40
    height: int = 30
    speed: float = 0.08
    times: float = 30.0
    """Duration, in diameters that the stream travels."""

    @property
    def thickness(self) -> float:
        return self.diameter + THICKER

    @property
    def size(self) -> tuple[int, int]:
        return self.length * self.diameter, self.height * self.diameter

    @property
    def steps(self) -> int:
        return round(self.times * self.diameter / self.speed)


def forces(case: Case, path: Path = JAX):
    """Return the fluid at the end, and drag and lift coefficients after every step."""
    dtype = jnp.dtype("float32")
    viscosity = case.speed * case.thickness / case.reynolds
    nodes = circle(case.diameter / 2, _centre(case))
    options = {
        "magic": fluid.capped_magic,
        "surroundings": fluid.Surroundings(sponge=_sponge(case, dtype)),
    }
    start = _start(case, dtype)
    f, received = around_held(nodes, viscosity, start, case.steps, path, **options)
    return f, -received.T / (0.5 * case.speed**2 * case.thickness)


def circle(radius: float, centre: tuple[float, float]) -> np.ndarray:
    """Return nodes on a circle, at most a cell apart."""
    nodes = int(np.ceil(2 * np.pi * radius))
    turn = 2 * np.pi * np.arange(nodes) / nodes
    return radius * np.stack([np.cos(turn), np.sin(turn)], 1) + np.array(centre)


def around_held(
    nodes: np.ndarray,
    viscosity: float,
    f: fluid.Populations,
    steps: int,
    path: Path,
    *,
    magic: Callable,
    surroundings: fluid.Surroundings,
) -> tuple[fluid.Populations, np.ndarray]:
    """Return the fluid after `steps` around held nodes, and the momentum received in each.

    The limit of 0 cells a step holds the nodes.
    """
    dtype, number = f[0].dtype, np.arange(len(nodes))
    body = bodies.from_edges(nodes, np.stack([number, np.roll(number, -1)], 1))
    options = {
        "size": f[0].shape,
        "surroundings": surroundings,
        "limits": world.Limits(displacement=jnp.zeros((), dtype)),
        "form": world.Form(
            projection=coupling.unprojected,
            forcing_iterations=5,
            kernel=coupling.PESKIN,
            magic=magic,
        ),
    }
    box, _ = scenes.immersed(body, viscosity, dtype, **options)
    start = replace(world.at_rest(box, jnp.asarray(nodes, dtype)), populations=f)
    end, force = roll(path, box, start, scenes.held(body, steps, dtype), scenes.force)
    return end.populations, np.asarray(force, float)[:, 0]


def _centre(case: Case) -> tuple[float, float]:
    """Return the centre, a third of the box behind the sponge."""
    # Off the axis and off the grid: in a symmetric start no wake would begin to oscillate.
    return 0.36 * case.size[0] + 0.3, case.size[1] / 2 + 0.2


def _sponge(case: Case, dtype) -> fluid.Sponge:
    """Return a sponge two diameters to either side of the box's seam, strongest at the seam."""
    x, reach = np.arange(case.size[0]), 2.0 * case.diameter
    distance = np.minimum(x, case.size[0] - x) / reach
    profile = 0.05 * np.where(distance < 1, np.cos(0.5 * np.pi * distance) ** 2, 0.0)
    strength = np.broadcast_to(profile[:, None], case.size)
    return fluid.Sponge(jnp.asarray(strength, dtype), jnp.asarray([case.speed, 0.0], dtype))


def _start(case: Case, dtype) -> fluid.Populations:
    """Return the free stream, with a swirl behind the cylinder from which a wake can grow."""
    x, y = np.meshgrid(*(np.arange(n) for n in case.size), indexing="ij")
    centre = _centre(case)
    away = (x - centre[0] - 2 * case.diameter) ** 2 + (y - centre[1]) ** 2
    swirl = 0.1 * case.speed * np.exp(-away / case.diameter**2)
    u = np.stack([np.full(case.size, case.speed), swirl])
    return fluid.equilibrium(jnp.ones(case.size, dtype), jnp.asarray(u, dtype))


def frequency(lift: np.ndarray) -> float:
    """Return the frequency per sample of a signal, by its upward passages through the mean."""
    signal = lift - lift.mean()
    before = np.flatnonzero((signal[:-1] < 0) & (signal[1:] >= 0))
    if len(before) < 2:
        return float("nan")
    # Interpolated between samples: a period has few of them.
    passages = before + signal[before] / (signal[before] - signal[before + 1])
    return (len(passages) - 1) / (passages[-1] - passages[0])


CASES = (Case(20), Case(40), Case(100, times=80.0))


def check(cases: tuple[Case, ...] = CASES, share: float = 0.08, path: Path = JAX) -> Result:
    rows, lines, plots = [], [], []
    for case in cases:
        f, (drag, lift) = forces(case, path)
        name, sheds = f"cylinder, Re {case.reynolds}", case.reynolds in STROUHAL
        travel = np.arange(case.steps) * case.speed / case.diameter
        last = travel > travel[-1] - (25 if sheds else 5)
        reference, source = DRAG[case.reynolds]
        mean = float(np.mean(drag[last]))
        rows.append(close(f"{name}: drag coefficient", mean, reference, share, source))
        shown = travel > 5  # The start from a uniform stream is off the scale.
        lines.append(Line(f"Re {case.reynolds}", travel[shown][::50], drag[shown][::50]))
        lines.append(Line("", [5, travel[-1]], [reference, reference], "k:"))
        if sheds:
            strouhal = frequency(lift[last]) * case.thickness / case.speed
            reference, source = STROUHAL[case.reynolds]
            rows.append(close(f"{name}: Strouhal number", strouhal, reference, share, source))
            spin = np.asarray(fluid.vorticity(jnp.stack(fluid.momentum(f))))
            third = case.size[1] // 3
            plots.append(Plot("wake", "x", "y", image=spin[:, third:-third]))
    axes = "travel of the stream / diameter", "drag coefficient"
    return Result(rows, [*plots, Plot("drag", *axes, tuple(lines))])


def series(share: float) -> float:
    """Return drag over viscosity and mean velocity by theory, for solid shares up to 0.2."""
    c = share
    return 4 * np.pi / (-0.5 * np.log(c) - 0.738 + c - 0.887 * c**2 + 2.038 * c**3)


def array_drag(radius: float, cell: int, path: Path = JAX) -> float:
    """Measure drag over viscosity and mean velocity of held nodes in a box of `cell` cells.

    A uniform force drives the flow; in the steady state it equals the cylinder's drag.
    """
    force, viscosity, steps = 1e-6, 0.5, 6000
    nodes = circle(radius, (cell / 2 + 0.3, cell / 2 + 0.1))
    still = tuple(jnp.zeros((cell, cell), jnp.float32) for _ in range(9))
    options = {
        "magic": fluid.fixed_magic,
        "surroundings": fluid.Surroundings(force=jnp.asarray([force, 0.0], jnp.float32)),
    }
    f, received = around_held(nodes, viscosity, still, steps, path, **options)
    mean_velocity = np.mean(np.asarray(fluid.momentum(f)[0], float)) + force / 2
    return float(-received[-1, 0] / (viscosity * mean_velocity))


def check_array(path: Path = JAX) -> Result:
    """Check that the error falls with the radius; the largest has the lowest bar."""
    radii, cell = (3, 5, 8), 64
    shares = [np.pi * radius**2 / cell**2 for radius in radii]
    drags = [array_drag(radius, cell, path) for radius in radii]
    errors = [drag / series(share) - 1 for drag, share in zip(drags, shares, strict=True)]
    what = "drag of a cylinder in an array, R = {:g}: relative error"
    rows = [
        at_most(what.format(radius), error, bar, SANGANI)
        for radius, error, bar in zip(radii, errors, (0.2, 0.2, 0.1), strict=True)
    ]
    falls = errors == sorted(errors)[::-1]
    rows.append(holds("the error falls with the radius", falls, SANGANI))
    fine = np.linspace(0.8 * shares[0], 1.2 * shares[-1], 100)
    theory = Line("series", fine, [series(share) for share in fine])
    lines = (theory, Line("here", shares, drags, "o"))
    axes = "solid share", "drag / (viscosity × mean velocity)"
    return Result(rows, [Plot("array", *axes, lines)])
