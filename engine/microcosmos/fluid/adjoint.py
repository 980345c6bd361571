"""The adjoint of a collision, written by hand.

Automatic differentiation stores and reads every intermediate plane of every step; this adjoint
stores only the inputs. Names in `_bar` are cotangents, in the reverse order of
`dynamics.collide`; `h` holds those of its result. `test_fluid` compares it with automatic
differentiation.
"""

import jax
import jax.numpy as jnp

from .dynamics import Rates, collide
from .lattice import PAIRS, WEIGHTS, Plane, Populations, Vectors, along

Inputs = tuple[Populations, Plane, tuple[Plane, Plane], Vectors, Rates]


@jax.custom_vjp
def collision(
    f: Populations, rho: Plane, momentum: tuple[Plane, Plane], force: Vectors, rates: Rates
) -> Populations:
    """Collide; reverse mode uses `adjoint`, forward mode is not supported."""
    return collide(f, rho, momentum, force, rates)


def _forward(*inputs) -> tuple[Populations, Inputs]:
    return collide(*inputs), inputs


def adjoint(inputs: Inputs, h: Populations) -> Inputs:
    """Return cotangents of the inputs of `collide` from those of its result."""
    f, rho, momentum, force, rates = inputs
    fx, fy = force[0], force[1]
    jx, jy = momentum[0] + 0.5 * fx, momentum[1] + 0.5 * fy
    ux, uy = jx / rho, jy / rho
    half_even, half_odd = 1.0 - 0.5 * rates.even, 1.0 - 0.5 * rates.odd
    keep = 1.0 - rates.even
    # `common` enters population i with the factor w_i, so its cotangent is the sum of w_i h_i.
    total = WEIGHTS[0] * h[0]
    f_bar, u_bar, j_bar, force_bar = [keep * h[0]], [], [], []
    even_bar, odd_bar = -h[0] * f[0], jnp.zeros_like(rho)
    pushed = jnp.zeros_like(rho)
    for i, j in PAIRS:
        w = WEIGHTS[i]
        cu, cj, cf = along(i, ux, uy), along(i, jx, jy), along(i, fx, fy)
        even, odd = h[i] + h[j], h[i] - h[j]
        same, other = 0.5 * keep * even, 0.5 * (1.0 - rates.odd) * odd
        f_bar += [same + other, same - other]
        total = total + w * even
        u_bar.append(w * even * (4.5 * rates.even * cj + 9.0 * half_even * cf))
        j_bar.append(w * (even * (4.5 * rates.even * cu) + 3.0 * rates.odd * odd))
        force_bar.append(w * (even * (9.0 * half_even * cu) + 3.0 * half_odd * odd))
        even_bar = even_bar - 0.5 * even * (f[i] + f[j]) + 4.5 * w * even * cu * cj
        odd_bar = odd_bar - 0.5 * odd * (f[i] - f[j]) + 3.0 * w * odd * (cj - 0.5 * cf)
        pushed = pushed + 9.0 * w * even * cu * cf
    ux_bar, uy_bar = _back(u_bar)
    jx_bar, jy_bar = _back(j_bar)
    fx_bar, fy_bar = _back(force_bar)
    # u = j / ρ: the cotangent of u, complete after the sum over pairs, goes on to j and ρ.
    scaled, braked = 1.5 * rates.even * total, 3.0 * half_even * total
    ux_bar, uy_bar = ux_bar - scaled * jx - braked * fx, uy_bar - scaled * jy - braked * fy
    jx_bar, jy_bar = jx_bar - scaled * ux + ux_bar / rho, jy_bar - scaled * uy + uy_bar / rho
    # j has half a step of force (Guo), so half of its cotangent goes on to the force.
    fx_bar, fy_bar = fx_bar - braked * ux + 0.5 * jx_bar, fy_bar - braked * uy + 0.5 * jy_bar
    rho_bar = rates.even * total - (ux_bar * ux + uy_bar * uy) / rho
    even_bar = even_bar + total * (rho - 1.0 - 1.5 * (jx * ux + jy * uy))
    even_bar = even_bar - 0.5 * (pushed - 3.0 * total * (ux * fx + uy * fy))
    rates_bar = Rates(jnp.sum(even_bar), jnp.sum(odd_bar))
    return tuple(f_bar), rho_bar, (jx_bar, jy_bar), jnp.stack([fx_bar, fy_bar]), rates_bar


def _back(bars: list[Plane]) -> tuple[Plane, Plane]:
    """Return the transpose of `along`, summed over the four pairs of directions."""
    x, y, diagonal, antidiagonal = bars
    return x + (diagonal + antidiagonal), y + (diagonal - antidiagonal)


collision.defvjp(_forward, adjoint)
