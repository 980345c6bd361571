"""Measures of the form of a body at rest."""

from typing import Any

import numpy as np

FORMS = (
    "segments",
    "limbs",
    "rings",
    "total_length",
    "form_symmetry",
    "form_aspect",
    "ungrown",
)
"""Names of the measures of form."""


def form(
    positions: Any, edges: Any, present: Any, there: Any, xp: Any = np, pieces: int = 1
) -> dict[str, Any]:
    """Measure a body at rest: `positions` (node, 2) in cells, `edges` (edge, 2).

    `present` (node,) and `there` (edge,) mask what has grown. Segments are filaments between
    ends and branches, limbs are free ends, rings are independent loops. The total length is in
    cells. Symmetry is that of the best mirror along a principal axis through the mean node: 1
    less the mean distance from a mirrored node to the nearest node, over half the radius of
    gyration, at least 0. The aspect is the width over the length, of second moments.
    No segment is `ungrown` for want of room where no plan says so.
    """
    reals = positions.dtype
    node = xp.arange(len(positions))
    ends = (edges[:, :, None] == node[None, None]) & there[:, None, None]
    degree = xp.sum(ends.reshape(-1, len(node)), 0)
    count, links = xp.sum(present).astype(reals), xp.sum(there).astype(reals)
    joined = xp.sum(xp.where(degree != 2, degree, 0)).astype(reals)
    kept = xp.where(present[:, None], positions, 0)
    middle = xp.sum(kept, 0) * (1 / count)
    arms = xp.where(present[:, None], positions - middle[None], 0)
    xx, yy = (xp.sum(arms[:, axis] * arms[:, axis]) for axis in (0, 1))
    xy = xp.sum(arms[:, 0] * arms[:, 1])
    half = xp.sqrt((xx - yy) * (xx - yy) / 4 + xy * xy + 1e-12)
    mean = (xx + yy) / 2
    narrow = xp.maximum(mean - half, 0) / xp.maximum(mean + half, 1e-12)
    # Half the angle of the axis of second moments, without trigonometry.
    double = xp.clip((xx - yy) / (2 * half), -1, 1)
    c = xp.sqrt((1 + double) / 2)
    s = xp.where(xy < 0, -1, 1) * xp.sqrt(xp.maximum(1 - double, 0) / 2)
    along, across = c * arms[:, 0] + s * arms[:, 1], c * arms[:, 1] - s * arms[:, 0]
    radius = xp.sqrt((xx + yy) / count + 1e-12)
    mirrored = [
        _mismatch(along, across, sign, present, count, xp) for sign in ((1, -1), (-1, 1))
    ]
    v = positions[edges[:, 1]] - positions[edges[:, 0]]
    lengths = xp.where(there, xp.sqrt(xp.sum(v * v, 1) + 1e-12), 0)
    unlike = xp.minimum(*mirrored) / (0.5 * radius)
    found = {
        "segments": xp.maximum(joined / 2, 1),
        "limbs": xp.sum(degree == 1).astype(reals),
        "rings": links - count + pieces,
        "total_length": xp.sum(lengths),
        "form_symmetry": xp.maximum(1 - unlike, 0),
        "form_aspect": xp.sqrt(narrow),
        "ungrown": 0,
    }
    return {name: xp.asarray(value, reals) for name, value in found.items()}


def _mismatch(along: Any, across: Any, sign: Any, present: Any, count: Any, xp: Any) -> Any:
    """Return the mean distance from each mirrored node to the nearest one."""
    dx = sign[0] * along[:, None] - along[None]
    dy = sign[1] * across[:, None] - across[None]
    square = xp.where(present[None], dx * dx + dy * dy, np.inf)
    nearest = xp.sqrt(xp.min(square, 1) + 1e-12)
    return xp.sum(xp.where(present, nearest, 0)) / count
