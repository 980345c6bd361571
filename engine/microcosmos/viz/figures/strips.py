"""Film strips of the kinds of motion in archives, from recorded poses."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...archive.file import load
from ...archive.poses import FRAMES, STROKES, PoseStream, streams
from ...archive.variety import exemplars as of_each_kind
from .sheet import numerals
from .style import GREY, INK, PALE, blank, palette

COLUMNS = 2
GAP = 0.12
"""Gap between poses, in body lengths."""


@dataclass(frozen=True, eq=False)
class Strip:
    """A stroke of an elite; places are in body lengths, the centre moves upwards."""

    fitness: float
    poses: np.ndarray
    """(frame, node, 2), about the mean of the nodes in each frame."""
    edges: np.ndarray
    advance: float
    """Path of the centre in the stroke, in body lengths."""


def exemplars(files: Sequence[bytes], most: int) -> list[Strip]:
    """Return the fittest elite of each kind of motion in archive files, at most `most`."""
    fitness, recorded = [], []
    for data in files:
        tree, attributes = load(data)
        fitness += tree["archive"]["fitness"].tolist()
        recorded += streams(tree, attributes)
    # Stable: equal elites stand in the order of files and cells, on every machine.
    order = np.argsort(-np.array(fitness), kind="stable")
    kinds = of_each_kind([recorded[i] for i in order], most)
    return [strip(fitness[order[i]], recorded[order[i]]) for i in kinds]


def strip(fitness: float, stream: PoseStream) -> Strip:
    """Return the last stroke of a pose stream; all of it without two strokes."""
    cells = stream.cells.astype(float) / stream.length
    if stream.strokes:
        cells = cells[-FRAMES // STROKES - 1 :]
    middle = cells.mean(1)
    across, along = middle[-1] - middle[0]
    size = float(np.hypot(across, along))
    # The world's axes are turned so that the way is (0, size).
    turn = np.array([[along, -across], [across, along]]) / size if size > 1e-9 else np.eye(2)
    return Strip(fitness, (cells - middle[:, None]) @ turn.T, stream.edges, size)


def strips(
    shown: Sequence[Strip], *, moments: int = 8, colours: str = "viridis", width: float = 178.0
) -> Any:
    """Draw each stroke as poses side by side, which are equal in scale and in time apart."""
    rows = -(-len(shown) // COLUMNS)
    posed = [_poses(one, moments) for one in shown]
    step = GAP + max(np.ptp(poses[..., 0], 1).max() for poses in posed)
    tall = GAP + max(np.ptp(poses[..., 1]) for poses in posed)
    length = (moments + 0.5) * step
    figure = blank(width, width / COLUMNS * tall / length * rows + 2 * rows)
    panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    names = numerals(len(shown))
    for panel in panels[len(shown) :]:
        panel.set_axis_off()
    for panel, one, poses, name in zip(panels, shown, posed, names, strict=False):
        middle = (poses[..., 1].min() + poses[..., 1].max()) / 2
        low, high = middle - tall / 2, middle + tall / 2
        panel.set(xlim=(-step / 2, length - step / 2), ylim=(low, high), aspect="equal")
        panel.set(xticks=[], yticks=[])
        panel.spines[:].set_color(PALE)
        _draw(panel, one, poses, step, colours)
        _arrow(panel, length - 0.75 * step, middle, one.advance)
        look = {"fontsize": 5.5, "transform": panel.transAxes}
        panel.text(0.005, 0.97, name, va="top", color=INK, **look)
        panel.text(
            0.995, 0.03, f"{one.fitness:.3g}", ha="right", va="bottom", color=GREY, **look
        )
    return figure


def _poses(one: Strip, moments: int) -> np.ndarray:
    """Return poses at equal parts of the stroke, without its end, which repeats its start."""
    frames = np.rint(np.linspace(0, len(one.poses) - 1, moments + 1)).astype(int)[:-1]
    return one.poses[frames]


def _draw(panel: Any, one: Strip, poses: np.ndarray, step: float, colours: str) -> None:
    from matplotlib.collections import LineCollection

    shade = palette(colours)
    for number, pose in enumerate(poses):
        places = pose + np.array([number * step, 0])
        colour = shade(0.9 * number / len(poses))
        look = {"colors": [colour], "linewidths": 1.4, "capstyle": "round"}
        panel.add_collection(LineCollection(list(places[one.edges]), **look))
        panel.plot(*places[0], "o", color=colour, ms=2.4, mew=0)


def _arrow(panel: Any, x: float, middle: float, advance: float) -> None:
    ends = {"xy": (x, middle + advance / 2), "xytext": (x, middle - advance / 2)}
    style = {"arrowstyle": "->", "lw": 0.7, "color": INK, "shrinkA": 0, "shrinkB": 0}
    panel.annotate("", **ends, arrowprops=style)
