"""Figures of the document."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from .rows import Plot

METADATA = {"Software": None}
"""Left out, so that the same figure gives the same bytes."""


def save(plot: Plot, path: Path) -> None:
    """Writes a figure as PNG."""
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.add_subplot(xlabel=plot.x, ylabel=plot.y)
    if plot.image is not None:
        reach = float(np.percentile(np.abs(plot.image), 99.5))
        axes.imshow(
            plot.image.T, origin="lower", cmap="RdBu_r", vmin=-reach, vmax=reach, aspect="equal"
        )
    for line in plot.lines:
        axes.plot(line.x, line.y, line.style, label=line.name or None)
    if "x" in plot.logarithmic:
        places = sorted({float(x) for line in plot.lines for x in line.x})
        axes.set_xscale("log")
        axes.set_xticks(places, [f"{x:g}" for x in places])
        axes.minorticks_off()
    if "y" in plot.logarithmic:
        axes.set_yscale("log")
    if any(line.name for line in plot.lines):
        axes.legend(frameon=False)
    figure.savefig(path, dpi=120, metadata=METADATA)
