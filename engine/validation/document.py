"""The validation document: text, tables and figures."""

import textwrap
from pathlib import Path

import jax
import numpy as np
from matplotlib.figure import Figure

from .rows import Plot, Result, Row
from .suite import Section

HEAD = """# Validation

`make validate` writes this page; `tests/engine/validation` runs the same checks, the longest of
them reduced. All values are in lattice units, and in float32 unless stated. A line passes if
*here* is within its bar.
"""


def document(results: list[tuple[Section, Result]], pictures: str) -> str:
    """Return the whole text; `pictures` is the figures' folder relative to it."""
    rows = [row for _, result in results for row in result.rows]
    failed = sum(not row.passed for row in rows)
    verdict = f"**{failed} FAIL**" if failed else "all pass"
    machine = f"jax {jax.__version__}, {jax.default_backend()}"
    parts = [HEAD, f"{len(rows)} lines, {verdict}. {machine}.\n"]
    parts += [_section(section, result, pictures) for section, result in results]
    return "\n".join(parts)


def figure_name(plot: str) -> str:
    return f"validation-{plot}.png"


def _section(section: Section, result: Result, pictures: str) -> str:
    lines = [f"## {section.title}\n", textwrap.fill(section.text, 100), ""]
    lines += ["| quantity | reference | here | bar | |", "|---|---|---|---|---|"]
    lines += [_line(row) for row in result.rows]
    for plot in result.plots:
        path = Path(pictures) / figure_name(plot.name)
        lines.append(f"\n![{section.title}: {plot.y} against {plot.x}]({path.as_posix()})")
    return "\n".join(lines) + "\n"


def _line(row: Row) -> str:
    reference = row.source
    if row.reference is not None:
        reference = f"{row.reference:.4g} ({row.source})"
    verdict = "pass" if row.passed else "**FAIL**"
    return f"| {row.quantity} | {reference} | {row.value:.4g} | {row.bar} | {verdict} |"


def save(plot: Plot, path: Path) -> None:
    """Write a figure as PNG."""
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axes = figure.add_subplot(xlabel=plot.x, ylabel=plot.y)
    if plot.image is not None:
        reach = float(np.percentile(np.abs(plot.image), 99.5))
        axes.imshow(plot.image.T, origin="lower", cmap="RdBu_r", vmin=-reach, vmax=reach)
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
    # Without `Software` the same figure gives the same bytes.
    figure.savefig(path, dpi=120, metadata={"Software": None})
