"""Maps of an archive: every cell in the colour of a measure; maps of re-projections."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...archive.measured import described
from ...archive.principal import Component
from ...archive.reprojection import Reprojection
from . import style
from .reading import Archive, Axis, chosen, fitness_label, label_axes, measure_label
from .style import EMPTY, GREY, INK, blank, colour_bar, lettered, linear_scale, palette, styled


def archive(
    elites: Archive,
    *,
    axes: list[str] | None = None,
    colour: str = "fitness",
    colours: str = "viridis",
    width: float = 85.0,
) -> Any:
    """Return the map over one or two axes; where elites share a place, the fittest is shown.

    `colour` is fitness or any other measure; a ring marks the fittest elite.
    """
    along = chosen(elites, axes)
    known = {"fitness": elites.fitness, **elites.measures}
    if colour not in known:
        raise ValueError(f"`colour` must be one of {', '.join(known)}, got {colour!r}.")
    shown = known[colour].astype(float)
    title = fitness_label(elites) if colour == "fitness" else measure_label(elites, colour)
    figure = blank(width, width * (0.78 if len(along) == 2 else 0.6))
    panel = figure.add_subplot()
    look = {"cmap": palette(colours), "norm": _scale(elites, colour, shown)}
    draw = _bars if len(along) == 1 else _cells if _over_all_axes(elites, along) else _bins
    drawn = draw(panel, elites, along, shown, look)
    label_axes(panel, along)
    if len(along) == 2:
        x, y = (elites.measures[axis.name][elites.best] for axis in along)
        x, y = (np.clip(v, a.low, a.high) for v, a in zip((x, y), along, strict=True))
        # The fittest often lies at a border, which would cut its ring.
        for edge, size in (("white", 1.8), (INK, 0.8)):
            panel.plot(x, y, "o", ms=5, mfc="none", mec=edge, mew=size, clip_on=False)
    colour_bar(panel, drawn, title, pad=0.02, aspect=28)
    return figure


def _scale(elites: Archive, name: str, shown: np.ndarray) -> Any:
    from matplotlib.colors import LogNorm

    own = {axis.name: axis.scale for axis in elites.axes}
    low, high = float(shown.min()), float(shown.max())
    # A logarithm needs positive values: a measure that is 0 somewhere has a linear scale.
    if own.get(name, described(name).scale) == "log10" and low > 0:
        return LogNorm(low, high if high > low else 10 * low)
    return linear_scale(shown)


def _over_all_axes(elites: Archive, along: list[Axis]) -> bool:
    """Return whether the map is over all axes of Voronoi cells, so that it can show them."""
    names = [axis.name for axis in elites.axes]
    return elites.centroids is not None and sorted(a.name for a in along) == sorted(names)


def bins(elites: Archive, along: list[Axis]) -> np.ndarray:
    """Return the bin of each elite (axis, elite); from its cell if the axis is a grid's.

    An archive with a container has places instead of cells: measures tell the bin.
    """
    own = [axis.name for axis in elites.axes]
    grid = elites.centroids is None and not elites.pool
    places = np.unravel_index(elites.cells, elites.spec.archive.shape) if grid else ()

    def bins_of(axis: Axis) -> np.ndarray:
        if grid and axis.name in own:
            return places[own.index(axis.name)]
        share = axis.places(elites.measures[axis.name])
        return np.minimum((share * axis.bins).astype(int), axis.bins - 1)

    return np.stack([bins_of(axis) for axis in along])


def fittest(elites: Archive, places: np.ndarray) -> np.ndarray:
    """Return the rows of the fittest elites, one for each occupied place (axis, elite)."""
    order = np.lexsort((-elites.fitness, *places))
    new = np.any(np.diff(places[:, order], axis=1) != 0, axis=0)
    return order[np.concatenate([[True], new])]


def _bins(
    panel: Any, elites: Archive, along: list[Axis], shown: np.ndarray, shades: Any
) -> Any:
    x, y = along
    occupied = bins(elites, along)
    rows = fittest(elites, occupied)
    values = np.full((y.bins, x.bins), np.nan)
    values[occupied[1, rows], occupied[0, rows]] = shown[rows]
    return _mesh(panel, along, values, **shades)


def _mesh(panel: Any, along: list[Axis], values: np.ndarray, **look: Any) -> Any:
    """Draw values (y, x) in the bins of two axes, NaN as empty."""
    x, y = along
    panel.set_facecolor(EMPTY)
    mesh = panel.pcolormesh(x.edges, y.edges, np.ma.masked_invalid(values), **look)
    # Without edges, viewers of PDF files show gaps between cells.
    mesh.set(edgecolor="face", linewidth=0.1)
    return mesh


def _cells(
    panel: Any, elites: Archive, along: list[Axis], shown: np.ndarray, shades: Any
) -> Any:
    from matplotlib.collections import PolyCollection

    assert elites.centroids is not None
    own = [axis.name for axis in elites.axes]
    order = [own.index(axis.name) for axis in along]
    x, y = along
    shapes = [
        np.stack([x.values(corners[:, 0]), y.values(corners[:, 1])], 1)
        for corners in cells(elites.centroids[:, order])
    ]
    look = {"edgecolors": "white", "linewidths": 0.25}
    panel.add_collection(PolyCollection(shapes, facecolors=EMPTY, **look))
    filled = PolyCollection([shapes[cell] for cell in elites.cells], **look, **shades)
    filled.set_array(shown)
    panel.add_collection(filled)
    return filled


def _bars(
    panel: Any, elites: Archive, along: list[Axis], shown: np.ndarray, shades: Any
) -> Any:
    from matplotlib.cm import ScalarMappable

    (axis,) = along
    if _over_all_axes(elites, along):
        assert elites.centroids is not None
        ends = axis.values(borders(elites.centroids[:, 0]))
        rows, low, high = np.arange(len(shown)), ends[elites.cells, 0], ends[elites.cells, 1]
    else:
        occupied = bins(elites, along)
        rows = fittest(elites, occupied)
        low, high = axis.edges[occupied[0, rows]], axis.edges[occupied[0, rows] + 1]
    drawn = ScalarMappable(**shades)
    height, colours = elites.fitness[rows], drawn.to_rgba(shown[rows])
    panel.bar(low, height, high - low, align="edge", color=colours, ec="white", lw=0.25)
    panel.set_ylabel(fitness_label(elites), parse_math=False)
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
    diagram = Voronoi(whole)
    corners = [
        diagram.vertices[diagram.regions[k]] for k in diagram.point_region[: len(points)]
    ]
    return [_round(points[i], np.clip(own, 0, 1)) for i, own in enumerate(corners)]


def borders(centroids: np.ndarray) -> np.ndarray:
    """Return the ends (cell, 2) of each centroid's cell on one axis."""
    order = np.argsort(centroids)
    inside = (centroids[order][1:] + centroids[order][:-1]) / 2
    ends = np.concatenate([[0.0], inside, [1.0]])
    ends_of_cells = np.empty((len(centroids), 2))
    ends_of_cells[order] = np.stack([ends[:-1], ends[1:]], 1)
    return ends_of_cells


def _round(middle: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Sort corners by their angle around a point inside."""
    away = corners - middle
    return corners[np.argsort(np.arctan2(away[:, 1], away[:, 0]))]


WIDTHS = {1: 85.0, 2: 178.0}
"""Width in mm for this number of maps."""


def draw_reprojections(
    path: Path, shown: Mapping[str, Reprojection], learned: Sequence[Component], run: str
) -> list[Path]:
    """Draw a map of each re-projection, over the same two axes; return the paths.

    Raises `ValueError` for another number of axes.
    """
    style.kind(path)
    first = next(iter(shown.values()))
    if len(first.axes) != 2:
        raise ValueError(f"`figure` needs two axes, got {len(first.axes)}")
    along = labelled(first, learned)
    with styled():
        figure = reprojections(list(shown.values()), along)
        return style.publish(figure, path, reprojection_caption(shown, along, run))


def reprojections(shown: Sequence[Reprojection], along: list[Axis]) -> Any:
    """Return the figure, with one scale of fitness."""
    width = WIDTHS[len(shown)]
    figure = blank(width, 66.0)
    panels = list(np.atleast_1d(figure.subplots(1, len(shown), sharey=True)))
    fitness = [one.creatures.fitness[one.elites].astype(float) for one in shown]
    scale = linear_scale(np.concatenate(fitness))
    x, y = along
    mesh = None
    for panel, one, heights in zip(panels, shown, fitness, strict=True):
        values = np.full(x.bins * y.bins, np.nan)
        values[one.filled] = heights
        values = values.reshape(x.bins, y.bins).T
        mesh = _mesh(panel, along, values, cmap=palette("viridis"), norm=scale)
        label_axes(panel, along)
    for panel in panels[1:]:
        panel.set_ylabel("")
    lettered(panels)
    colour_bar(panels[-1], mesh, "Fitness", pad=0.02, aspect=28)
    return figure


def labelled(one: Reprojection, learned: Sequence[Component]) -> list[Axis]:
    """Return the axes with labels."""
    shares = {component.name: component.explained for component in learned}
    axes = []
    for axis in one.axes:
        label = described(axis.name).label
        if axis.name in shares:
            label = f"Principal component {axis.name[2:]} ({shares[axis.name]:.0%} of variance)"
        ends = (axis.low, axis.high, axis.scale == "log10", axis.bins)
        axes.append(Axis(axis.name, label, *ends))
    return axes


def reprojection_caption(
    shown: Mapping[str, Reprojection], along: Sequence[Axis], run: str
) -> str:
    """Return the caption."""
    several = len(shown) > 1
    figures = [
        f"{f'({chr(97 + i)}) ' if several else ''}{name}, {len(one.last):,} cells filled "
        f"({one.coverage:.1%}), QD score {one.qd_score:.4g}"
        for i, (name, one) in enumerate(shown.items())
    ]
    over = " and ".join(axis.label[0].lower() + axis.label[1:] for axis in along)
    cells = f"{along[0].bins} × {along[1].bins} cells"
    return (
        f"The fittest creature of each of {cells} over {over}, of {run}: {'; '.join(figures)}."
    )
