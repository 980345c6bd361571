"""Measures of the form of a body at rest."""

from typing import Any

import numpy as np


def form(
    positions: Any, edges: Any, present: Any, edge_present: Any, xp: Any = np, pieces: int = 1
) -> dict[str, Any]:
    """Measure a body at rest: `positions` (node, 2) in cells, `edges` (edge, 2).

    `present` (node,) and `edge_present` (edge,) mask grown nodes and edges. Segments are
    filaments between ends and branches, free ends are nodes with one edge, rings are
    independent loops. The total length is in cells. Symmetry is that of the best mirror
    through the mean node, along or across the first axis, a principal axis or the way to
    the farthest node: 1 less the mean distance from a mirrored node to the nearest node,
    over half the radius of gyration, at least 0. The aspect is the width over the length,
    of second moments. `ungrown` is 0; the caller replaces it for a body that grew from a
    plan.
    """
    reals = positions.dtype
    node = xp.arange(len(positions))
    ends = (edges[:, :, None] == node[None, None]) & edge_present[:, None, None]
    degree = xp.sum(ends.reshape(-1, len(node)), 0)
    count, links = xp.sum(present).astype(reals), xp.sum(edge_present).astype(reals)
    joined = xp.sum(xp.where(degree != 2, degree, 0)).astype(reals)
    kept = xp.where(present[:, None], positions, 0)
    # XLA multiplies by the reciprocal of a single number, so NumPy has to.
    middle = xp.sum(kept, 0) * (1 / count)
    arms = xp.where(present[:, None], positions - middle[None], 0)
    xx, yy = (xp.sum(arms[:, axis] * arms[:, axis]) for axis in (0, 1))
    xy = xp.sum(arms[:, 0] * arms[:, 1])
    half = xp.sqrt((xx - yy) * (xx - yy) / 4 + xy * xy + 1e-12)
    mean = (xx + yy) / 2
    narrow = xp.maximum(mean - half, 0) / xp.maximum(mean + half, 1e-12)
    radius = xp.sqrt((xx + yy) / count + 1e-12)
    mirrored = [
        _mismatch(c * arms[:, 0] + s * arms[:, 1], c * arms[:, 1] - s * arms[:, 0], *one)
        for c, s in _axes(arms, xx, yy, xy, half, xp)
        for one in ((1, -1, present, count, xp), (-1, 1, present, count, xp))
    ]
    v = positions[edges[:, 1]] - positions[edges[:, 0]]
    lengths = xp.where(edge_present, xp.sqrt(xp.sum(v * v, 1) + 1e-12), 0)
    unlike = xp.min(xp.stack(mirrored)) / (0.5 * radius)
    measures = {
        "segments": xp.maximum(joined / 2, 1),
        "free_ends": xp.sum(degree == 1).astype(reals),
        "rings": links - count + pieces,
        "total_length": xp.sum(lengths),
        "form_symmetry": xp.maximum(1 - unlike, 0),
        "form_aspect": xp.sqrt(narrow),
        "ungrown": 0,
    }
    return {name: xp.asarray(value, reals) for name, value in measures.items()}


def _axes(arms: Any, xx: Any, yy: Any, xy: Any, half: Any, xp: Any) -> list[tuple[Any, Any]]:
    """Return cosine and sine of the mirrors; the first axis where rounding would decide."""
    one, zero = xp.ones_like(half), xp.zeros_like(half)
    # Half the angle of the axis of second moments, without trigonometry.
    double = xp.clip((xx - yy) / (2 * half), -1, 1)
    c = xp.sqrt((1 + double) / 2)
    s = xp.where(xy < 0, -1, 1) * xp.sqrt(xp.maximum(1 - double, 0) / 2)
    # A nearly round body has no principal axis but the one that rounding errors choose.
    long = half > 0.01 * (xx + yy)
    square = xp.sum(arms * arms, 1)
    # The first of those that are equally far but for rounding errors.
    far = arms[xp.argmax(square >= 0.999 * xp.max(square))]
    size = xp.sqrt(xp.sum(far * far) + 1e-12)
    principal = xp.where(long, c, one), xp.where(long, s, zero)
    return [(one, zero), principal, (far[0] / size, far[1] / size)]


def _mismatch(
    along: Any, across: Any, u: int, v: int, present: Any, count: Any, xp: Any
) -> Any:
    """Return the mean distance from each node, mirrored by `u` and `v`, to the nearest one."""
    dx = u * along[:, None] - along[None]
    dy = v * across[:, None] - across[None]
    square = xp.where(present[None], dx * dx + dy * dy, np.inf)
    nearest = xp.sqrt(xp.min(square, 1) + 1e-12)
    return xp.sum(xp.where(present, nearest, 0)) / count
