"""Collision with two relaxation times, Guo's forcing, and streaming.

Two relaxation times: Ginzburg, Verhaeghe and d'Humieres, Commun. Comput. Phys. 3, 427 (2008).
Forcing: Guo, Zheng and Shi, Phys. Rev. E 65, 046308 (2002), eqs. 3, 4 and 20.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .lattice import DIRECTIONS, PAIRS, WEIGHTS, Plane, Populations, Vectors, along

Scalar = Float[Array, ""]

MAGIC = 3 / 16
"""Λ that puts a straight bounce-back wall halfway and makes steady errors independent of τ."""


class Rates(eqx.Module):
    """Inverse relaxation times of the even and odd parts of the populations."""

    even: Scalar
    odd: Scalar


def fixed_magic(tau: Scalar) -> Scalar:
    """Return Λ = 3/16 at every viscosity; unstable with moving bodies below ν of about 0.01."""
    return jnp.full_like(tau, MAGIC)


def capped_magic(tau: Scalar) -> Scalar:
    """Return Λ = 3/16, lowered near τ = 1/2: the odd relaxation time stays at most 1."""
    # Measured: at ν = 0.001 Λ = 3/16 makes the odd time 63, and even a calm worm diverges.
    return jnp.minimum(MAGIC, 0.5 * (tau - 0.5))


def rates(viscosity: Scalar, magic=capped_magic) -> Rates:
    """Return relaxation rates for a `viscosity` in cells² a step: τ = 3 ν + 1/2.

    The odd time follows from Λ = (τ − 1/2) (τ_odd − 1/2), see `magic`.
    """
    even_time = 3.0 * viscosity + 0.5
    odd_time = magic(even_time) / (even_time - 0.5) + 0.5
    return Rates(1.0 / even_time, 1.0 / odd_time)


def collide(
    f: Populations,
    rho: Plane,
    momentum: tuple[Plane, Plane],
    force: Vectors | tuple[Plane, Plane],
    rates: Rates,
) -> Populations:
    """Relax towards equilibrium and add the source of a force density.

    `rho` and `momentum` are the moments of `f`, without force. `adjoint` is the derivative of
    this function: change both.
    """
    fx, fy = force[0], force[1]
    # The velocity of Guo's scheme is that at the half step: half of the force has acted.
    jx, jy = momentum[0] + 0.5 * fx, momentum[1] + 0.5 * fy
    ux, uy = jx / rho, jy / rho
    half_even, half_odd = 1.0 - 0.5 * rates.even, 1.0 - 0.5 * rates.odd
    # Terms of the even parts that are the same for all directions.
    common = rates.even * (rho - 1.0 - 1.5 * (jx * ux + jy * uy))
    common = common - half_even * 3.0 * (ux * fx + uy * fy)
    keep = 1.0 - rates.even
    out = [keep * f[0] + WEIGHTS[0] * common]
    # Opposite directions share products: their even parts are equal, their odd parts opposite.
    for i, j in PAIRS:
        w = WEIGHTS[i]
        cu, cj, cf = along(i, ux, uy), along(i, jx, jy), along(i, fx, fy)
        even = keep * 0.5 * (f[i] + f[j])
        even = even + w * (common + cu * (4.5 * rates.even * cj + 9.0 * half_even * cf))
        odd = (1.0 - rates.odd) * 0.5 * (f[i] - f[j])
        odd = odd + 3.0 * w * (rates.odd * cj + half_odd * cf)
        out += [even + odd, even - odd]
    return tuple(out)


def stream(f: Populations) -> Populations:
    """Move each population one cell along its direction in the periodic box."""
    return tuple(
        jnp.roll(plane, c, (0, 1)) if any(c) else plane
        for plane, c in zip(f, DIRECTIONS, strict=True)
    )


def vorticity(u: Vectors) -> Plane:
    """Return ∂u_y/∂x − ∂u_x/∂y by central differences, in 1/step."""
    dx = jnp.roll(u[1], -1, 0) - jnp.roll(u[1], 1, 0)
    dy = jnp.roll(u[0], -1, 1) - jnp.roll(u[0], 1, 1)
    return 0.5 * (dx - dy)
