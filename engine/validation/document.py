"""The validation document: text, tables and figures."""

import textwrap
from pathlib import Path

import jax
import numpy as np
from matplotlib.figure import Figure

from microcosmos import device

from .rows import Findings, Pair, Plot
from .suite import Section

HEAD = """# Validation

`make validate` writes this page; `tests/engine/validation` runs the same checks, the longest of
them reduced. All values are in lattice units, and in float32 unless stated.

The checks run twice: in pure JAX, the reference, and in the native kernel, which the column
*kernel* shows. Bars are the same. A line passes if each of its values is within its bar. Where
a reference follows from the result itself, that of JAX comes first. Pictures show the results
of JAX.
"""
ALONE = "The native kernel is not installed or not chosen here: its column has dashes.\n"
DASH = "–"


def document(results: list[tuple[Section, Findings]], pictures: str) -> str:
    """Return the whole text; `pictures` is the figures' folder relative to it."""
    lines = [pair for _, findings in results for pair in findings.pairs]
    failed = sum(not pair.passed for pair in lines)
    verdict = f"**{failed} FAIL**" if failed else "all pass"
    covered = sum(pair.kernel is not None for pair in lines)
    machine = f"jax {jax.__version__}, {jax.default_backend()}"
    kernel = device.kernel_version()
    machine += f", microcosmos-kernels {kernel}" if kernel else ""
    counts = f"{len(lines)} lines, {covered} of them in the kernel too, {verdict}."
    parts = [HEAD, f"{counts} {machine}.\n"]
    parts += [] if kernel else [ALONE]
    parts += [_section(section, findings, pictures) for section, findings in results]
    return "\n".join(parts)


def figure_name(plot: str) -> str:
    return f"validation-{plot}.png"


def _section(section: Section, findings: Findings, pictures: str) -> str:
    text = " ".join(
        [section.text, *(check.lacking for check in section.checks if check.lacking)]
    )
    lines = [f"## {section.title}\n", textwrap.fill(text, 100), ""]
    lines += ["| quantity | reference | JAX | kernel | bar | |", "|---|---|---|---|---|---|"]
    lines += [_line(pair) for pair in findings.pairs]
    for plot in findings.plots:
        path = Path(pictures) / figure_name(plot.name)
        lines.append(f"\n![{section.title}: {plot.y} against {plot.x}]({path.as_posix()})")
    return "\n".join(lines) + "\n"


def _line(pair: Pair) -> str:
    row, rows = pair.jax, pair.rows.values()
    # A reference can be calculated from the result itself, and so differ.
    references = dict.fromkeys(f"{x.reference:.4g}" for x in rows if x.reference is not None)
    reference = f"{' / '.join(references)} ({row.source})" if references else row.source
    values = [f"{x.value:.4g}" for x in rows]
    values = " | ".join([*values, DASH][:2])
    missed = [name for name, x in pair.rows.items() if not x.passed]
    verdict = f"**FAIL** {', '.join(missed)}" if missed else "pass"
    return f"| {row.quantity} | {reference} | {values} | {row.bar} | {verdict} |"


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
