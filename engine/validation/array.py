"""Slow flow through a square array of cylinders: the drag of one of them.

Sangani and Acrivos, Int. J. Multiphase Flow 8, 193 (1982): the series in the solid share c.
"""

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import coupling, fluid

from . import immersed
from .rows import Found, Line, Plot, at_most, holds

SOURCE = "Sangani and Acrivos 1982"


def series(share: float) -> float:
    """Drag over viscosity and mean velocity, for a solid share of up to about 0.2."""
    c = share
    return 4 * np.pi / (-0.5 * np.log(c) - 0.738 + c - 0.887 * c**2 + 2.038 * c**3)


def drag(radius: float, cell: int, steps: int, viscosity: float = 0.5) -> float:
    """The same of held nodes around one cylinder in a periodic box of `cell` cells.

    A uniform force drives the flow; when it is steady, the cylinder takes up all of it.
    """
    dtype, force = jnp.dtype("float32"), 1e-6
    surroundings = fluid.Surroundings(force=jnp.asarray([force, 0.0], dtype))
    rates = fluid.rates(jnp.asarray(viscosity, dtype), fluid.fixed_magic)
    nodes = immersed.circle(radius, (cell / 2 + 0.3, cell / 2 + 0.1), dtype)

    def step(f, _):
        answer = immersed.step(
            f,
            nodes,
            jnp.zeros_like(nodes),
            rates,
            surroundings=surroundings,
            projection=coupling.unprojected,
            iterations=5,
        )
        return answer.populations, answer.given[0]

    still = tuple(jnp.zeros((cell, cell), dtype) for _ in range(9))
    f, given = jax.jit(lambda f: jax.lax.scan(step, f, None, length=steps))(still)
    mean_velocity = np.mean(np.asarray(fluid.momentum(f)[0], float)) + force / 2
    return float(-given[-1] / (viscosity * mean_velocity))


def check(radii: tuple[float, ...] = (3, 5, 8), cell: int = 64, steps: int = 6000) -> Found:
    """The bar is for the largest radius; below it only has to be worse."""
    shares = [np.pi * radius**2 / cell**2 for radius in radii]
    exact = [series(share) for share in shares]
    here = [drag(radius, cell, steps) for radius in radii]
    errors = [a / b - 1 for a, b in zip(here, exact, strict=True)]
    bars = [*(0.2 for _ in radii[1:]), 0.1]
    rows = [
        at_most(
            f"drag of a cylinder in an array, R = {radius:g}: relative error",
            error,
            bar,
            SOURCE,
        )
        for radius, error, bar in zip(radii, errors, bars, strict=True)
    ]
    rows.append(
        holds("the error falls with the radius", errors == sorted(errors)[::-1], SOURCE)
    )
    fine = np.linspace(0.8 * shares[0], 1.2 * shares[-1], 100)
    lines = (
        Line("series", fine, [series(share) for share in fine]),
        Line("here", shares, here, "o"),
    )
    return Found(
        rows, [Plot("array", "solid share", "drag / (viscosity × mean velocity)", lines)]
    )
