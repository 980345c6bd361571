"""The cells of a centroidal Voronoi tessellation, cut at the sides of the unit square."""

import numpy as np


def cells(centroids: np.ndarray) -> list[np.ndarray]:
    """The corners (corner, 2) of the cell around each centroid (cell, 2), in order.

    Centroids are mirrored at the four sides: the borders between them and their mirror images
    are the sides themselves.
    """
    from scipy.spatial import Voronoi

    points = centroids.astype(float)
    x, y = points.T
    images = [(-x, y), (2 - x, y), (x, -y), (x, 2 - y)]
    whole = np.concatenate([points, *(np.stack(image, 1) for image in images)])
    found = Voronoi(whole)
    corners = [found.vertices[found.regions[k]] for k in found.point_region[: len(points)]]
    return [_round(points[i], np.clip(own, 0, 1)) for i, own in enumerate(corners)]


def borders(centroids: np.ndarray) -> np.ndarray:
    """(cell, 2): from where to where the cell of each centroid on one axis goes."""
    order = np.argsort(centroids)
    inside = (centroids[order][1:] + centroids[order][:-1]) / 2
    ends = np.concatenate([[0.0], inside, [1.0]])
    found = np.empty((len(centroids), 2))
    found[order] = np.stack([ends[:-1], ends[1:]], 1)
    return found


def _round(middle: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Corners in the order of their angle around a point inside."""
    away = corners - middle
    return corners[np.argsort(np.arctan2(away[:, 1], away[:, 0]))]
