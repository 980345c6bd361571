"""The D2Q9 lattice and its moments, in lattice units (dx = dt = 1).

Populations are stored as deviations from the weights w_i, so that float32 keeps the mass
of a fluid nearly at rest (Skordos, Phys. Rev. E 48, 4823, 1993).
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

Plane = Float[Array, "x y"]
Populations = tuple[Plane, ...]  # Nine planes: XLA is slow on a stack of them.
Vectors = Float[Array, "2 x y"]

# Rest first, then opposite directions side by side: i and i + 1 for odd i.
DIRECTIONS = ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1))
WEIGHTS = (4 / 9, 1 / 9, 1 / 9, 1 / 9, 1 / 9, 1 / 36, 1 / 36, 1 / 36, 1 / 36)
PAIRS = ((1, 2), (3, 4), (5, 6), (7, 8))


def density(f: Populations) -> Plane:
    """Return the mass in each cell, 1 at rest."""
    return 1.0 + deviation(f)


def deviation(f: Populations) -> Plane:
    """Return the density minus 1."""
    # Populations of a calm fluid are small beside 1: added to it first, they would lose digits.
    return f[0] + ((f[1] + f[2]) + (f[3] + f[4])) + ((f[5] + f[6]) + (f[7] + f[8]))


def momentum(f: Populations) -> tuple[Plane, Plane]:
    """Return the momentum in each cell, without the half step of force; see `moving`."""
    diagonal, antidiagonal = f[5] - f[6], f[7] - f[8]
    return (
        (f[1] - f[2]) + (diagonal + antidiagonal),
        (f[3] - f[4]) + (diagonal - antidiagonal),
    )


def fastest(rho: Plane, momentum: tuple[Plane, Plane]) -> Float[Array, ""]:
    """Return the largest speed of the fluid, cells a step."""
    x, y = momentum
    # One root of the largest square; the constant keeps it differentiable in a fluid at rest.
    return jnp.sqrt(jnp.max((x * x + y * y) / (rho * rho)) + 1e-24)


def along(direction: int, x: Plane, y: Plane) -> Plane:
    """Return c_i · (x, y) for an odd `direction`, without multiplying by 0 and ±1."""
    return (x, y, x + y, x - y)[direction // 2]


def equilibrium(rho: Plane, u: Vectors) -> Populations:
    """Return the second-order equilibrium at density `rho` and velocity `u`, as deviations."""
    square = 1.5 * (u[0] * u[0] + u[1] * u[1])
    f = [WEIGHTS[0] * (rho - 1.0 - rho * square)]
    for i, _ in PAIRS:
        cu = along(i, u[0], u[1])
        even = WEIGHTS[i] * (rho - 1.0 + rho * (4.5 * cu * cu - square))
        odd = WEIGHTS[i] * 3.0 * rho * cu
        f += [even + odd, even - odd]
    return tuple(f)
