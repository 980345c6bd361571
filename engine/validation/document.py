"""The document that the checks are written to: text, tables and figures."""

import textwrap
from pathlib import Path

import jax

from .rows import Found, Row
from .suite import Section

HEAD = """# Validation

`make validate` writes this page; `tests/engine/validation` runs the same checks, the longest of
them reduced. All values are in lattice units, and in float32 unless stated. A line passes if
*here* is within its bar.
"""


def document(found: list[tuple[Section, Found]], pictures: str) -> str:
    """The whole text; figures lie in the folder `pictures` as seen from it."""
    rows = [row for _, one in found for row in one.rows]
    missed = [row for row in rows if not row.passed]
    verdict = "all pass" if not missed else f"**{len(missed)} FAIL**"
    machine = f"jax {jax.__version__}, {jax.default_backend()}"
    parts = [HEAD, f"{len(rows)} lines, {verdict}. {machine}.\n"]
    parts += [_section(section, one, pictures) for section, one in found]
    return "\n".join(parts)


def figure_name(plot: str) -> str:
    return f"validation-{plot}.png"


def _section(section: Section, found: Found, pictures: str) -> str:
    lines = [f"## {section.title}\n", textwrap.fill(section.text, 100), ""]
    lines += ["| quantity | reference | here | bar | |", "|---|---|---|---|---|"]
    lines += [_line(row) for row in found.rows]
    lines += [f"\n{row.quantity}: {row.note}" for row in found.rows if row.note]
    for plot in found.plots:
        path = Path(pictures) / figure_name(plot.name)
        lines.append(f"\n![{section.title}: {plot.y} against {plot.x}]({path.as_posix()})")
    return "\n".join(lines) + "\n"


def _line(row: Row) -> str:
    reference = row.source
    if row.reference is not None:
        reference = f"{row.reference:.4g} ({row.source})"
    verdict = "pass" if row.passed else "**FAIL**"
    return f"| {row.quantity} | {reference} | {row.here:.4g} | {row.bar} | {verdict} |"
