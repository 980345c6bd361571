"""Points through which a filament acts on the fluid: its nodes, or two layers beside them.

Two layers thicken a filament of no thickness into a solid (Mittal and Iaccarino, Annu. Rev.
Fluid Mech. 37, 239, 2005, as the Microcosmos paper uses it). Both move with the node: layers
that turn with the cross-section would stretch, and cancel propulsion.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

Vectors = Float[Array, "node 2"]

OFFSET = 0.5
"""Distance of a layer from the filament in cells; at 1 the coupling is unstable."""


def points(positions: Vectors, normals: Vectors, layers: int) -> Float[Array, "point 2"]:
    """Return `layers` points for every node, side by side."""
    if layers == 1:
        return positions
    beside = jnp.stack([positions + OFFSET * normals, positions - OFFSET * normals], 1)
    return beside.reshape(-1, 2)


def at_points(values: Vectors, layers: int) -> Float[Array, "point 2"]:
    """Repeat the value of each node at its points."""
    return values if layers == 1 else jnp.repeat(values, layers, 0)


def at_nodes(values: Float[Array, "point 2"], layers: int) -> Vectors:
    """Return the mean over the points of each node."""
    return values if layers == 1 else jnp.mean(values.reshape(-1, layers, 2), 1)
