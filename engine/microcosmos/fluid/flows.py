"""Steady flows in closed form, the forces that drive them, and populations in these flows.

Poiseuille flow is driven by a uniform force between walls, Kolmogorov flow by a sine force. The
vortices of Taylor and Green are a steady solution under F = ν |k|² u: their inertia is balanced
by their pressure. A periodic box has no linear shear; a sine wave has one near its zeros.
"""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from .lattice import DIRECTIONS, WEIGHTS, Populations, equilibrium

Plane = Float[np.ndarray, "x y"]
Size = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Developed:
    """A steady flow, cell by cell."""

    velocity: Float[np.ndarray, "2 x y"]
    density: Plane
    strain: tuple[Plane, Plane, Plane]
    """∂u_x/∂x, ∂u_y/∂y and (∂u_x/∂y + ∂u_y/∂x) / 2."""
    force: Float[np.ndarray, "2 x y"] | Float[np.ndarray, "2"]
    """The force density that keeps the flow up; one for all cells if it is uniform."""


def poiseuille(size: Size, speed: float, viscosity: float) -> Developed:
    """Return the flow along x between walls in the row y = 0; `speed` is that in the middle."""
    # Bounce-back puts walls halfway between cells: row 1 is half a cell away from its wall.
    across = size[1] - 1.0
    y = np.maximum(np.arange(size[1]) - 0.5, 0.0)
    u, slope = (
        4 * speed * y * (across - y) / across**2,
        4 * speed * (across - 2 * y) / across**2,
    )
    slope[0] = 0  # The wall itself is not sheared.
    force = np.array([8 * viscosity * speed / across**2, 0.0])
    return _along_x(size, u, slope, force)


def shear(size: Size, speed: float, viscosity: float) -> Developed:
    """Return the flow along x with u = `speed` sin(2 π y / height).

    Its shear is strongest in the middle of the box.
    """
    k = 2 * np.pi / size[1]
    y = np.arange(size[1])
    u, slope = speed * np.sin(k * y), speed * k * np.cos(k * y)
    wave = np.broadcast_to(u, size)
    force = viscosity * k**2 * np.stack([wave, 0 * wave])
    return _along_x(size, u, slope, force)


def vortices(size: Size, speed: float, viscosity: float, count: int) -> Developed:
    """Return `count` × `count` vortices, one with its centre in the middle of the box.

    The stream function is A cos(kx x) cos(ky y), about the middle.
    """
    kx, ky = (np.pi * count / side for side in size)
    places = (np.arange(side) - side / 2 for side in size)
    x, y = np.meshgrid(*places, indexing="ij")
    strength = speed / max(kx, ky)
    cx, sx, cy, sy = np.cos(kx * x), np.sin(kx * x), np.cos(ky * y), np.sin(ky * y)
    u = strength * np.stack([-ky * cx * sy, kx * sx * cy])
    pressure = -(strength**2 / 4) * (ky**2 * np.cos(2 * kx * x) + kx**2 * np.cos(2 * ky * y))
    stretch = strength * kx * ky * sx * sy
    twist = 0.5 * strength * (kx**2 - ky**2) * cx * cy
    force = viscosity * (kx**2 + ky**2) * u
    # The pressure is the deviation of the density times the square of the speed of sound, 1/3.
    return Developed(u, 1 + 3 * pressure, (stretch, -stretch, twist), force)


def developed(flow: Developed, viscosity: float) -> Populations:
    """Return the populations of a steady flow: equilibrium and the viscous stress.

    The stress is that of Chapman and Enskog, to first order.
    """
    force = flow.force if flow.force.ndim == 3 else flow.force[:, None, None]
    tau, (xx, yy, xy) = 3 * viscosity + 0.5, flow.strain
    # Populations carry the momentum before the half step of force that `collide` adds.
    u = flow.velocity - 0.5 * force / flow.density[None]
    f = equilibrium(jnp.asarray(flow.density), jnp.asarray(u))
    return tuple(
        plane - 3 * tau * w * flow.density * _stress(c, xx, yy, xy)
        for plane, w, c in zip(f, WEIGHTS, DIRECTIONS, strict=True)
    )


def _stress(c: tuple[int, int], xx: Plane, yy: Plane, xy: Plane) -> Plane:
    # Q : ∇u with Q = c c − I/3.
    return c[0] ** 2 * xx + c[1] ** 2 * yy + 2 * c[0] * c[1] * xy - (xx + yy) / 3


def _along_x(size: Size, u: np.ndarray, slope: np.ndarray, force: np.ndarray) -> Developed:
    wave, none = np.broadcast_to(u, size), np.zeros(size)
    strain = none, none, np.broadcast_to(0.5 * slope, size)
    return Developed(np.stack([wave, none]), np.ones(size), strain, force)
