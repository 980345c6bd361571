"""Centroidal Voronoi tessellations of the unit cube, cached on disk.

Vassiliades, Chatzilygeroudis and Mouret, IEEE Trans. Evol. Comput. 22, 623 (2018): Lloyd's
algorithm on uniform samples. Samples and first centroids are low-discrepancy sequences in place
of random points: cells come out more equal after fewer rounds.
"""

import hashlib
import os
import sys
from io import BytesIO
from pathlib import Path

import numpy as np
import scipy
from jaxtyping import Float

from ..archive.atomic import write_whole
from ..bounds import refuse_uncountable

CACHE_VERSION = "lloyd/1"
"""Version in the cache's file names; change it if the same arguments give other centroids."""

# 16,384 centroids of two axes take 0.45 s, with a mean squared distance of 0.1725 cells; QDax's
# take 58 s, with 0.2080 (docs/evolution.md).
SAMPLES = 10
"""Samples per centroid; at least `MIN_SAMPLES` in all."""
MIN_SAMPLES = 50_000
ROUNDS = 10

Points = Float[np.ndarray, "point axis"]


def centroids(cells: int, axes: int, seed: int) -> Points:
    """Return float32 centroids, the same for the same arguments; from disk if cached."""
    refuse_uncountable(1, cells=cells, axes=axes)
    refuse_uncountable(0, seed=seed)
    path = folder() / f"{name(cells, axes, seed)}.npy"
    cached = _cached(path, (cells, axes))
    if cached is not None:
        return cached
    points = lloyd(cells, axes, seed).astype(np.float32)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = BytesIO()
        np.save(file, points)
        write_whole(path, file.getvalue())
    except OSError:  # Without the cache the result is the same.
        pass
    return points


def lloyd(cells: int, axes: int, seed: int) -> Points:
    """Return centroids by Lloyd's algorithm: each becomes the mean of its nearest samples."""
    # Named, since `default_rng` may choose another generator in a later NumPy.
    random = np.random.Generator(np.random.PCG64(seed))
    points = spread(cells, axes, random.random(axes))
    samples = spread(max(MIN_SAMPLES, SAMPLES * cells), axes, random.random(axes))
    samples = samples[np.lexsort(np.floor(samples * 64).T)]  # Neighbours together, for caches.
    for _ in range(ROUNDS):
        tree = scipy.spatial.KDTree(points, balanced_tree=False, compact_nodes=False)
        nearest = tree.query(samples, workers=-1)[1]
        count = np.bincount(nearest, minlength=cells)
        sums = [np.bincount(nearest, column, cells) for column in samples.T]
        means = np.stack(sums, 1) / np.maximum(count, 1)[:, None]
        points = np.where(count[:, None] > 0, means, points)
    return points


def spread(count: int, axes: int, shift: Float[np.ndarray, "axis"]) -> Points:
    """Spread points evenly: shift + n (1/φ, 1/φ² …) modulo 1, with φ^(axes + 1) = φ + 1.

    The additive recurrence of Roberts (2018), "The unreasonable effectiveness of quasirandom
    sequences"; on one axis it is that of the golden ratio.
    """
    phi = 2.0
    for _ in range(60):
        phi = (1 + phi) ** (1 / (axes + 1))
    steps = phi ** -np.arange(1.0, axes + 1)
    return (shift[None] + np.arange(count)[:, None] * steps[None]) % 1.0


def folder() -> Path:
    """Return the folder of the cache: in XDG_CACHE_HOME, else the platform's."""
    places = {"darwin": Path.home() / "Library" / "Caches"}
    if os.name == "nt" and "LOCALAPPDATA" in os.environ:
        places["win32"] = Path(os.environ["LOCALAPPDATA"])
    home = places.get(sys.platform, Path.home() / ".cache")
    return Path(os.environ.get("XDG_CACHE_HOME") or home) / "microcosmos" / "centroids"


def name(cells: int, axes: int, seed: int) -> str:
    """Return the SHA-256 of everything that determines the centroids."""
    text = f"{CACHE_VERSION} {cells} {axes} {seed} {SAMPLES} {MIN_SAMPLES} {ROUNDS}"
    return hashlib.sha256(text.encode()).hexdigest()


def _cached(path: Path, shape: tuple[int, int]) -> Points | None:
    try:
        points = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return None
    right = points.shape == shape and points.dtype == np.float32
    return points if right and np.all((points >= 0) & (points <= 1)) else None
