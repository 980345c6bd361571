"""The figure of a folding: each filament at some moments, its picture, and the losses."""

from functools import partial
from math import ceil
from typing import Any

import jax
import numpy as np

from ... import search, spec, world
from ...archive import file
from ...build import build_descent
from ...device import compiler_options
from ...genomes import Vector
from .style import COLOURS, GREY, INCH, blank, drawable, legend_of_groups, tidy

MOMENTS = {"early": 0.1, "middle": 0.4, "late": 1.0}
"""Moments of the figure, as shares of the simulation."""

COLUMNS = 10
"""Most filaments side by side."""


def folds(data: bytes) -> Any:
    """Draw every filament early, middle and late, its picture, and the losses.

    `data` is the run's file, finished or not; filaments with the least loss so far are
    simulated anew.
    """
    tree, attributes = file.load(data)
    chosen = spec.Folding.model_validate_json(attributes["spec"])
    names = [drawable(target.name) for target in chosen.targets]
    genes, pictures, least = (tree["folds"][name] for name in ("genes", "picture", "loss"))
    if not np.isfinite(least).any():
        raise ValueError("a folding with an update is needed, got one without.")
    courses = _courses(chosen, genes)
    banks, across = ceil(len(names) / COLUMNS), min(COLUMNS, len(names))
    rows = len(MOMENTS) + 1
    width, height = max(5.0, 1.05 * across + 0.6), 1.08 * rows * banks + 2.6
    figure = blank(INCH * width, INCH * height)
    grid = figure.add_gridspec(rows * banks + 1, across, height_ratios=[1] * rows * banks + [2])
    for number, name in enumerate(names):
        top, column = number // COLUMNS * rows, number % COLUMNS
        panels = [figure.add_subplot(grid[top + i, column]) for i in range(rows)]
        _column(panels, courses[number], pictures[number], chosen)
        panels[0].set_title(f"{name}: {least[number]:.4f}", fontsize=8, parse_math=False)
        if column == 0:
            for panel, label in zip(panels, (*MOMENTS, "picture"), strict=True):
                panel.set_ylabel(label, fontsize=8)
    _losses(figure.add_subplot(grid[-1, :]), tree["curves"]["loss"], names)
    return figure


def _courses(chosen: spec.Folding, genes: np.ndarray) -> np.ndarray:
    """Return positions (fold, moment, node, 2) of the nodes."""
    descent = build_descent(chosen)
    steps = [max(1, round(share * chosen.steps)) - 1 for share in MOMENTS.values()]

    def course(genes):
        driven = search.drive(descent.task, Vector(genes))
        _, seen = search.simulate(driven, lambda state, _: world.unwrapped(driven.world, state))
        return seen[np.array(steps)]

    program = jax.jit(partial(jax.lax.map, course), compiler_options=compiler_options())
    return np.asarray(program(genes))


def _column(
    panels: list[Any], course: np.ndarray, picture: np.ndarray, chosen: spec.Folding
) -> None:
    from matplotlib.collections import LineCollection

    size = np.array([chosen.world.width, chosen.world.height])
    edges = spec.shape(chosen.body).edges
    for panel, places in zip(panels, course, strict=False):
        panel.imshow(picture.T, origin="lower", cmap="Greys", vmin=0, vmax=3)
        ends = places[edges]  # In the periodic image that holds the middle.
        ends = ends - size * np.floor(ends.mean(1, keepdims=True) / size)
        panel.add_collection(LineCollection(list(ends), colors=COLOURS[0], lw=0.5))
        panel.plot(*ends[:, 0].T, ".", color=COLOURS[0], ms=0.9, mew=0)
    panels[-1].imshow(picture.T, origin="lower", cmap="Greys", vmin=0, vmax=1)
    for panel in panels:
        panel.set(xticks=[], yticks=[], xlim=(-0.5, size[0] - 0.5), ylim=(-0.5, size[1] - 0.5))
        panel.spines[:].set(color=GREY, lw=0.4)


def _losses(panel: Any, losses: np.ndarray, names: list[str]) -> None:
    for number, name in enumerate(names):
        panel.plot(losses[:, number], lw=1, color=COLOURS[number % len(COLOURS)],
                   ls="-" if number < len(COLOURS) else "--", label=name)  # fmt: skip
    panel.set(yscale="log", xlabel="update", ylabel="loss")
    tidy(panel)
    if len(names) > 1:
        legend_of_groups(panel, fontsize=7, ncols=5)
