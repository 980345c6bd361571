"""Maps of re-projections: the elites over other axes than the archive's."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...archive.principal import Component
from ...archive.reprojection import Reprojection
from ...spec.measures import MEASURES
from . import saving
from .axes import Axis, label_axes
from .style import EMPTY, blank, colour_bar, lettered, linear_scale, palette, styled

WIDTHS = {1: 85.0, 2: 178.0}
"""Width in mm for this number of maps."""


def draw(
    path: Path, shown: Mapping[str, Reprojection], learned: Sequence[Component], run: str
) -> list[Path]:
    """Draw a map of each re-projection, over the same two axes; return the paths.

    Raises `ValueError` for another number of axes.
    """
    saving.kind(path)
    first = next(iter(shown.values()))
    if len(first.axes) != 2:
        raise ValueError(f"`figure` needs two axes, got {len(first.axes)}")
    along = axes(first, learned)
    with styled():
        return saving.publish(maps(list(shown.values()), along), path, text(shown, along, run))


def maps(shown: Sequence[Reprojection], along: list[Axis]) -> Any:
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
        values = np.ma.masked_invalid(values.reshape(x.bins, y.bins).T)
        panel.set_facecolor(EMPTY)
        mesh = panel.pcolormesh(x.edges, y.edges, values, cmap=palette("viridis"), norm=scale)
        # Without edges, viewers of PDF files show gaps between cells.
        mesh.set(edgecolor="face", linewidth=0.1)
        label_axes(panel, along)
    for panel in panels[1:]:
        panel.set_ylabel("")
    lettered(panels)
    bar = {"pad": 0.02, "aspect": 28}
    colour_bar(panels[-1], mesh, "Fitness", **bar)
    return figure


def axes(one: Reprojection, learned: Sequence[Component]) -> list[Axis]:
    """Return the axes with labels."""
    shares = {component.name: component.explained for component in learned}
    found = []
    for axis in one.axes:
        known = MEASURES.get(axis.name)
        label = axis.name.replace("_", " ").capitalize()
        if known:
            label = known.title + (f" [{known.unit}]" if known.unit else "")
        elif axis.name in shares:
            label = f"Principal component {axis.name[2:]} ({shares[axis.name]:.0%} of variance)"
        ends = (axis.low, axis.high, axis.scale == "log10", axis.bins)
        found.append(Axis(axis.name, label, *ends))
    return found


def text(shown: Mapping[str, Reprojection], along: Sequence[Axis], run: str) -> str:
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
