"""Maps of an archive: every cell in the colour of its elite's fitness or another measure."""

from typing import Any

import numpy as np

from ...spec.measures import MEASURES
from .axes import Axis, chosen, fitness_label, label, label_axes
from .reading import Archive
from .style import EMPTY, GREY, INK, blank, colour_bar, linear_scale, palette


def archive(
    found: Archive,
    *,
    axes: list[str] | None = None,
    colour: str = "fitness",
    colours: str = "viridis",
    width: float = 85.0,
) -> Any:
    """Return the map over one or two axes; where elites share a place, the fittest is shown.

    `colour` is fitness or any other measure; a ring marks the fittest elite.
    """
    along = chosen(found, axes)
    known = {"fitness": found.fitness, **found.measures}
    if colour not in known:
        raise ValueError(f"`colour` must be one of {', '.join(known)}, got {colour!r}.")
    shown = known[colour].astype(float)
    title = fitness_label(found) if colour == "fitness" else label(found, colour)
    figure = blank(width, width * (0.78 if len(along) == 2 else 0.6))
    panel = figure.add_subplot()
    look = {"cmap": palette(colours), "norm": _scale(found, colour, shown)}
    draw = _bars if len(along) == 1 else _cells if _over_all_axes(found, along) else _bins
    drawn = draw(panel, found, along, shown, look)
    label_axes(panel, along)
    if len(along) == 2:
        x, y = (found.measures[axis.name][found.best] for axis in along)
        x, y = (np.clip(v, a.low, a.high) for v, a in zip((x, y), along, strict=True))
        for edge, size in (("white", 1.8), (INK, 0.8)):
            panel.plot(x, y, "o", ms=5, mfc="none", mec=edge, mew=size, clip_on=False)
    colour_bar(panel, drawn, title, pad=0.02, aspect=28)
    return figure


def _scale(found: Archive, name: str, shown: np.ndarray) -> Any:
    from matplotlib.colors import LogNorm

    scales = {known: measure.scale for known, measure in MEASURES.items()}
    scales |= {axis.name: axis.scale for axis in found.axes}
    low, high = float(shown.min()), float(shown.max())
    if scales.get(name) == "log10" and low > 0:
        return LogNorm(low, high if high > low else 10 * low)
    return linear_scale(shown)


def _over_all_axes(found: Archive, along: list[Axis]) -> bool:
    """Return whether the map is over all axes of Voronoi cells, so that it can show them."""
    names = [axis.name for axis in found.axes]
    return found.centroids is not None and sorted(a.name for a in along) == sorted(names)


def bins(found: Archive, along: list[Axis]) -> np.ndarray:
    """Return the bin of each elite (axis, elite); from its cell if the axis is a grid's.

    An archive with a container has places instead of cells: measures tell the bin.
    """
    own = [axis.name for axis in found.axes]
    grid = found.centroids is None and not found.pool
    places = np.unravel_index(found.cells, found.spec.archive.shape) if grid else ()

    def bins_of(axis: Axis) -> np.ndarray:
        if grid and axis.name in own:
            return places[own.index(axis.name)]
        share = axis.places(found.measures[axis.name])
        return np.minimum((share * axis.bins).astype(int), axis.bins - 1)

    return np.stack([bins_of(axis) for axis in along])


def fittest(found: Archive, places: np.ndarray) -> np.ndarray:
    """Return the rows of the fittest elites, one for each occupied place (axis, elite)."""
    order = np.lexsort((-found.fitness, *places))
    new = np.any(np.diff(places[:, order], axis=1) != 0, axis=0)
    return order[np.concatenate([[True], new])]


def _bins(panel: Any, found: Archive, along: list[Axis], shown: np.ndarray, shades: Any) -> Any:
    x, y = along
    there = bins(found, along)
    rows = fittest(found, there)
    values = np.full((y.bins, x.bins), np.nan)
    values[there[1, rows], there[0, rows]] = shown[rows]
    panel.set_facecolor(EMPTY)
    mesh = panel.pcolormesh(x.edges, y.edges, np.ma.masked_invalid(values), **shades)
    # Without edges, viewers of PDF files show gaps between cells.
    mesh.set(edgecolor="face", linewidth=0.1)
    return mesh


def _cells(
    panel: Any, found: Archive, along: list[Axis], shown: np.ndarray, shades: Any
) -> Any:
    from matplotlib.collections import PolyCollection

    assert found.centroids is not None
    own = [axis.name for axis in found.axes]
    order = [own.index(axis.name) for axis in along]
    x, y = along
    shapes = [
        np.stack([x.values(corners[:, 0]), y.values(corners[:, 1])], 1)
        for corners in cells(found.centroids[:, order])
    ]
    look = {"edgecolors": "white", "linewidths": 0.25}
    panel.add_collection(PolyCollection(shapes, facecolors=EMPTY, **look))
    filled = PolyCollection([shapes[cell] for cell in found.cells], **look, **shades)
    filled.set_array(shown)
    panel.add_collection(filled)
    return filled


def _bars(panel: Any, found: Archive, along: list[Axis], shown: np.ndarray, shades: Any) -> Any:
    from matplotlib.cm import ScalarMappable

    (axis,) = along
    if _over_all_axes(found, along):
        assert found.centroids is not None
        ends = axis.values(borders(found.centroids[:, 0]))
        rows, low, high = np.arange(len(shown)), ends[found.cells, 0], ends[found.cells, 1]
    else:
        there = bins(found, along)
        rows = fittest(found, there)
        low, high = axis.edges[there[0, rows]], axis.edges[there[0, rows] + 1]
    drawn = ScalarMappable(**shades)
    height, colours = found.fitness[rows], drawn.to_rgba(shown[rows])
    panel.bar(low, height, high - low, align="edge", color=colours, ec="white", lw=0.25)
    panel.set_ylabel(fitness_label(found))
    panel.axhline(0, color=GREY, lw=0.5)
    return drawn


def cells(centroids: np.ndarray) -> list[np.ndarray]:
    """Return the corners (corner, 2) of the cell around each centroid (cell, 2), in order.

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
    """Return the ends (cell, 2) of each centroid's cell on one axis."""
    order = np.argsort(centroids)
    inside = (centroids[order][1:] + centroids[order][:-1]) / 2
    ends = np.concatenate([[0.0], inside, [1.0]])
    found = np.empty((len(centroids), 2))
    found[order] = np.stack([ends[:-1], ends[1:]], 1)
    return found


def _round(middle: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Sort corners by their angle around a point inside."""
    away = corners - middle
    return corners[np.argsort(np.arctan2(away[:, 1], away[:, 0]))]
