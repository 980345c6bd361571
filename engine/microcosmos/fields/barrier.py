"""Obstacles keep bodies out: displacements of nodes near solid cells, away from these."""

import equinox as eqx
import numpy as np
from jaxtyping import Array, Bool, Float
from scipy.ndimage import distance_transform_edt

REACH = 1.5
"""Distance from the surface within which nodes are moved, in cells."""
LIMIT = 0.1
"""The largest displacement of a body in a step, in cells."""
MARGIN = 16
"""Cells beyond an edge of the periodic box that count for distances."""


class Barrier(eqx.Module):
    """Displacements of nodes near solid cells."""

    away: Float[Array, "2 x y"]
    """Displacement in a step, in cells."""
    limit: Float[Array, ""]
    """The largest displacement of a body in a step, in cells."""


def away(solid: Bool[np.ndarray, "x y"]) -> Float[np.ndarray, "2 x y"]:
    """Return displacements of one cell per cell of depth below `REACH`, along the normal.

    They are the gradient of half the square of the depth, by central differences: mirror
    images of a solid have mirror images of these. The surface lies half a cell outside the
    solid cells; deep inside a solid the depth is that below the nearest surface.
    """
    wide = np.pad(solid, MARGIN, mode="wrap")
    outside, inside = (np.asarray(distance_transform_edt(one)) for one in (~wide, wide))
    height = np.where(wide, 0.5 - inside, outside - 0.5)
    potential = 0.5 * np.maximum(REACH - height, 0) ** 2
    kept = slice(MARGIN, -MARGIN)
    slopes = [np.gradient(potential, axis=axis)[kept, kept] for axis in (0, 1)]
    return -np.stack(slopes)
