"""Checks of undisturbed flows against closed forms, and of mass and momentum."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import bodies, coupling, fluid, world

from . import scenes
from .paths import JAX, Path, roll
from .rows import Line, Plot, Result, Row, at_least, at_most

EXACT = "closed form"
VISCOUS_TIMES = 5
THIN = 4
"""Cells along an axis on which a flow does not depend: the window of a delta needs them."""


def distance(u, exact) -> float:
    """Return the relative L2 distance of two fields."""
    u, exact = np.asarray(u, float), np.asarray(exact, float)
    return float(np.sqrt(np.sum((u - exact) ** 2) / np.sum(exact**2)))


def after(
    f: fluid.Populations,
    steps: int,
    viscosity: float,
    magic: Callable = fluid.capped_magic,
    around: fluid.Surroundings | None = None,
    path: Path = JAX,
) -> fluid.Populations:
    """Return the fluid after a rollout whose body goes with the flow and exerts no force."""
    dtype, body = f[0].dtype, bodies.chain(2, 1.0)
    form = world.Form(
        projection=coupling.unprojected, force_factor=0.0, forcing_iterations=1, magic=magic
    )
    around = fluid.Surroundings() if around is None else around
    options = {"size": f[0].shape, "form": form, "surroundings": around}
    box, start = scenes.immersed(body, viscosity, dtype, **options)
    rest = scenes.held(body, steps, dtype)
    return roll(path, box, replace(start, populations=f), rest)[0].populations


def velocity(f: fluid.Populations, force: fluid.Vectors) -> fluid.Vectors:
    """Return the velocity, with the half step of force of Guo's scheme."""
    return (jnp.stack(fluid.momentum(f)) + 0.5 * force) / fluid.density(f)[None]


def _decayed(u, rho, viscosity, magic, steps, dtype, path):
    """Return the velocity after `steps` from equilibrium at density `rho` and velocity `u`."""
    f = fluid.equilibrium(jnp.asarray(rho, dtype), jnp.asarray(u, dtype))
    end = after(f, steps, viscosity, magic, path=path)
    return velocity(end, jnp.zeros((2, *f[0].shape), dtype))


def shear_wave_rate(
    tau: float, magic: Callable, dtype: Any, n: int = 64, path: Path = JAX
) -> float:
    """Return the rate at which a transverse wave decays, divided by ν k²."""
    k, viscosity = 2 * np.pi / n, (tau - 0.5) / 3
    wave = np.broadcast_to(np.sin(k * np.arange(n))[:, None], (n, THIN))
    u, rho = 0.01 * np.stack([0 * wave, wave]), np.ones((n, THIN))
    life = 1 / (viscosity * k**2)
    # The stress forms in the first tenth of the lifetime, which does not count.
    early, late = (round(share * life) for share in (0.1, 1.1))
    heights = [
        np.sum(np.asarray(_decayed(u, rho, viscosity, magic, s, dtype, path)[1], float) * wave)
        for s in (early, late)
    ]
    return float(np.log(heights[0] / heights[1]) / (late - early) * life)


def kolmogorov_error(tau: float, magic: Callable, dtype: Any, n: int = 64) -> float:
    """Return the distance from the steady flow under a sine force, in which the fluid starts.

    The flow is uniform along x, so two cells of length suffice.
    """
    k, viscosity = 2 * np.pi / n, (tau - 0.5) / 3
    wave = np.broadcast_to(np.sin(k * np.arange(n)), (2, n))
    exact = 0.01 * np.stack([wave, 0 * wave])
    force = jnp.asarray(viscosity * k**2 * exact, dtype)
    rates = fluid.rates(jnp.asarray(viscosity, dtype), magic)
    # At large τ the start without viscous stress decays more slowly than the flow.
    steps = 2000 + round(VISCOUS_TIMES / (viscosity * k**2))

    def step(_, f):
        rho, momentum = fluid.density(f), fluid.momentum(f)
        return fluid.advance(f, rho, momentum, force, rates, fluid.Surroundings())

    f = fluid.equilibrium(jnp.ones((2, n), dtype), jnp.asarray(exact, dtype))
    f = jax.jit(lambda f: jax.lax.fori_loop(0, steps, step, f))(f)
    return distance(velocity(f, force), exact)


def taylor_green_error(
    n: int, tau: float, magic: Callable, dtype: Any, speed: float = 0.01, path: Path = JAX
) -> float:
    """Return the distance from decaying vortices, which start with their pressure field."""
    k, viscosity = 2 * np.pi / n, (tau - 0.5) / 3
    x, y = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    u = np.stack([-np.cos(k * x) * np.sin(k * y), np.sin(k * x) * np.cos(k * y)]) * speed
    # Without the pressure field sound waves would spoil the order of convergence.
    rho = 1 - 0.75 * speed**2 * (np.cos(2 * k * x) + np.cos(2 * k * y))
    steps = round(1 / (4 * viscosity * k**2))
    end = _decayed(u, rho, viscosity, magic, steps, dtype, path)
    return distance(end, u * np.exp(-2 * viscosity * k**2 * steps))


def orders(dtype: Any, sizes: tuple[int, ...] = (16, 32, 64), path: Path = JAX) -> list[float]:
    """Return the order of convergence of Taylor-Green vortices between successive sizes."""
    # The Mach number falls with the cell size, else its error would remain.
    magic = fluid.fixed_magic
    errors = [
        taylor_green_error(n, 0.8, magic, dtype, speed=0.64 / n, path=path) for n in sizes
    ]
    return [float(x) for x in np.log2(np.array(errors[:-1]) / errors[1:])]


WIDTH = 31
"""Cells between the walls of a channel."""


def poiseuille(
    tau: float, magic: Callable, dtype: Any, path: Path = JAX
) -> tuple[float, float]:
    """Return the walls' offset from halfway, in cells, and the relative L2 error of the flow.

    The parabola through the velocities vanishes at the walls. The fluid starts at rest.
    """
    size, viscosity = (THIN, WIDTH + 1), (tau - 0.5) / 3
    push = 8 * viscosity * 0.01 / WIDTH**2
    solid = jnp.zeros(size, bool).at[:, 0].set(True)
    uniform = jnp.asarray([push, 0.0], dtype)
    still = tuple(jnp.zeros(size, dtype) for _ in range(9))
    steps = 2000 + round(4 * WIDTH**2 / viscosity)
    around = fluid.Surroundings(uniform, solid)
    f = after(still, steps, viscosity, magic, around, path)
    force = jnp.broadcast_to(uniform[:, None, None], (2, *size))
    u = np.asarray(velocity(f, force), float)[0, 0, 1:]
    y = np.arange(WIDTH) + 0.5
    walls = np.sort(np.roots(np.polyfit(y, u, 2)).real)
    exact = push / (2 * viscosity) * y * (WIDTH - y)
    return float(np.max(np.abs(walls - [0, WIDTH]))), distance(u, exact)


FIXED, CAPPED = ("fixed", fluid.fixed_magic), ("capped", fluid.capped_magic)
TAUS = (0.53, 0.6, 0.8, 1.0, 2.0, 6.5)
"""Viscosities from 0.01 to 2."""


def check_shear_wave(
    taus: tuple[float, ...] = TAUS, dtype: Any = "float32", path: Path = JAX
) -> Result:
    """Check the decay; the bar grows with τ ν k², which the scheme needs to be small."""
    rows = []
    for tau in taus:
        error = abs(shear_wave_rate(tau, fluid.fixed_magic, dtype, path=path) - 1)
        bar = max(1e-3, round(1.2 * tau * (tau - 0.5) / 3 * (2 * np.pi / 64) ** 2, 4))
        what = f"shear wave, τ {tau:g}: relative error of decay"
        rows.append(at_most(what, error, bar, EXACT))
    return Result(rows)


def check_kolmogorov(dtype: Any = "float32") -> Result:
    rows, lines = [], []
    for (kind, magic), taus, bar in ((FIXED, TAUS, 1e-3), (CAPPED, (0.53, 0.6, 0.8), 2e-3)):
        errors = [kolmogorov_error(tau, magic, dtype) for tau in taus]
        for tau, error in zip(taus, errors, strict=True):
            what = f"Kolmogorov flow, Λ {kind}, τ {tau:g}: relative L2"
            rows.append(at_most(what, error, bar, EXACT))
        lines.append(Line(f"Λ {kind}", taus, errors, "o-"))
    return Result(
        rows, [Plot("kolmogorov", "τ", "relative L2 error", tuple(lines), None, "xy")]
    )


def check_taylor_green(dtype: Any = "float32", path: Path = JAX) -> Result:
    """Check the error and that it falls with the square of the cell size."""
    rows, taus = [], (0.53, 0.6, 0.8)
    for (kind, magic), at, bar in ((FIXED, (*taus, 1.0), 1.5e-3), (CAPPED, taus, 2e-3)):
        for tau in at:
            error = taylor_green_error(64, tau, magic, dtype, path=path)
            what = f"Taylor-Green vortices, Λ {kind}, τ {tau:g}: relative L2"
            rows.append(at_most(what, error, bar, EXACT))
    for order, sizes in zip(orders(dtype, path=path), ("16 to 32", "32 to 64"), strict=True):
        what = f"order of convergence, {sizes} cells"
        rows.append(at_least(what, order, 1.9, 2.0, "second-order scheme"))
    return Result(rows)


CHANNELS = (0.53, 0.6, 1.0, 2.0, 6.5)


def check_poiseuille(
    taus: tuple[float, ...] = CHANNELS,
    capped: tuple[float, ...] = (0.53,),
    dtype: Any = "float64",
    path: Path = JAX,
) -> Result:
    """Check the walls and the flow of a channel: at Λ = 3/16 nothing but rounding is left.

    A step may round the velocity by 2⁻²³ of it in float32. That acts as a force does, and the
    driving force is 8 ν / width² of the velocity.
    """
    with jax.enable_x64(dtype == "float64"):
        rows = []
        for tau in taus:
            share = 2**-23 * WIDTH**2 / (8 * (tau - 0.5) / 3)
            bar = 1e-9 if dtype == "float64" else float(f"{share:.1e}")
            rows += _channel(FIXED, tau, bar, dtype, path)
        for tau in capped:
            rows += _channel(CAPPED, tau, 1e-2, dtype, path)
    return Result(rows)


def _channel(form, tau: float, bar: float, dtype: Any, path: Path) -> list[Row]:
    kind, magic = form
    walls, error = poiseuille(tau, magic, dtype, path)
    flow = f"Poiseuille flow, {dtype}, Λ {kind}, τ {tau:g}"
    return [
        at_most(f"{flow}: walls off halfway (cells)", walls, bar, EXACT),
        at_most(f"{flow}: relative L2", error, bar, EXACT),
    ]


def check_conservation(
    size: tuple[int, int] = (64, 64), dtype: Any = "float32", path: Path = JAX
) -> Result:
    """Check the drift of mass, and of momentum over cells times speed, from random flow."""
    rows, law, steps, speed = [], "conservation", 10_000, 0.01
    for viscosity in (0.01, 0.1, 2.0):
        random = np.random.default_rng(0)
        f = tuple(jnp.asarray(random.uniform(-speed, speed, size), dtype) for _ in range(9))
        end = after(f, steps, viscosity, path=path)
        masses = [np.sum(np.asarray(fluid.density(g), float)) for g in (f, end)]
        momenta = [np.sum(np.asarray(fluid.momentum(g), float), (1, 2)) for g in (f, end)]
        mass = abs(masses[1] - masses[0]) / masses[0]
        momentum = np.max(np.abs(momenta[1] - momenta[0])) / (size[0] * size[1] * speed)
        after_steps = f"after {steps:,} steps, ν {viscosity:g}"
        rows.append(at_most(f"drift of mass {after_steps}", mass, 1e-6, law))
        rows.append(at_most(f"drift of momentum {after_steps}", momentum, 1e-4, law))
    return Result(rows)
