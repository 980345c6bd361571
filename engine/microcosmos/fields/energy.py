"""The field of energy that creatures sense and collect.

It is that of the Microcosmos paper: Gaussian packets at random places. Nodes may consume it;
it may diffuse.
"""

from dataclasses import dataclass

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .. import exact

Plane = Float[Array, "x y"]


class Energy(eqx.Module):
    """The initial field, its diffusion and consumption."""

    start: Plane
    diffusion: Float[Array, ""] | None
    """Cells² a step, at most 1/4; None: no diffusion."""
    rate: Float[Array, ""] | None
    """Share of the covered energy that a node takes in a step; None: no consumption."""


@dataclass(frozen=True)
class Packets:
    """Gaussians at places drawn from a seed."""

    count: int
    width: float
    """Standard deviation in cells."""
    amplitude: float
    seed: int


def packets(size: tuple[int, int], chosen: Packets) -> np.ndarray:
    """Return the sum of all packets in a periodic box, with the images that reach into it."""
    places = np.random.default_rng(chosen.seed).uniform(0, size, (chosen.count, 2))
    planes = []
    for axis in range(2):
        away = np.arange(size[axis])[None] - places[:, axis, None]
        # Beyond 8 widths an image has less than 10⁻¹³ of its amplitude.
        boxes = 1 + int(np.ceil(8 * chosen.width / size[axis]))
        images = away[:, :, None] + size[axis] * np.arange(-boxes, boxes + 1)
        planes.append(exact.exponential(-0.5 * (images / chosen.width) ** 2).sum(-1))
    # One packet after another: a library adds up a matrix product in an order of its own, which
    # differs between processors (see `exact`).
    total = np.zeros(size)
    for x, y in zip(*planes, strict=True):
        total += x[:, None] * y[None]
    return chosen.amplitude * total


def placements(size: tuple[int, int], count: int, seed: int) -> np.ndarray:
    """Return shifts (placement, 2) of all packets in `count` worlds; the first is 0."""
    drawn = np.random.default_rng([seed, 1]).integers(0, size, (count - 1, 2))
    return np.concatenate([np.zeros((1, 2), int), drawn])


def diffuse(field: Plane, diffusion: Float[Array, ""]) -> Plane:
    """Return the field after an explicit step of diffusion, which keeps its sum."""
    around = sum(jnp.roll(field, shift, axis) for axis in (0, 1) for shift in (-1, 1))
    return field + diffusion * (around - 4 * field)


def collect(field: Plane, coverage: Plane, rate: Float[Array, ""]) -> tuple[Plane, Plane]:
    """Return the field after consumption, and the energy taken per unit of coverage.

    `coverage` is the number of nodes over each cell; together they take at most all its energy.
    Interpolated at a node, the second plane is what that node takes.
    """
    taken = rate / jnp.maximum(1.0, rate * coverage)
    return field * (1 - taken * coverage), field * taken
