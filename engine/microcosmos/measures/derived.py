"""Files that follow from the table: the kernel's index, the page's titles, the documentation.

`python -m microcosmos.measures index > engine/kernels/src/measures.h` writes the index,
`page` the file `web/src/api/measures.json`, and `table` the tables of the documentation.
"""

import json
from collections.abc import Iterator

from ..units import UNITS
from .table import GROUPS, MEASURES, SUMMARISED


def index() -> str:
    """Return the numbers of the measures in the native kernel, as a header of C++."""
    return "\n".join(
        [
            "// Places of the measures, written by `python -m microcosmos.measures index`.",
            "#pragma once",
            "",
            "namespace microcosmos {",
            "",
            "enum Measure {",
            *(f"  {name.upper()}," for name in SUMMARISED),
            "  MEASURE_COUNT",
            "};",
            "",
            "}  // namespace microcosmos",
            "",
        ]
    )


def page() -> str:
    """Return the page's table of measures as JSON: groups, then measures by name."""
    measures = {
        name: {"title": one.title, "unit": one.unit, "group": one.group, "about": one.about}
        for name, one in MEASURES.items()
    }
    lines = ",\n".join(f"    {json.dumps(one)}" for one in GROUPS.items())
    rows = ",\n".join(
        f"    {json.dumps(name)}: {_spaced(one)}" for name, one in measures.items()
    )
    return f'{{\n  "groups": [\n{lines}\n  ],\n  "measures": {{\n{rows}\n  }}\n}}\n'


def _spaced(entry: dict[str, str]) -> str:
    """Return JSON as the page's formatter leaves it."""
    return "{ " + json.dumps(entry, ensure_ascii=False)[1:-1] + " }"


def table() -> str:
    """Return the tables of the documentation."""
    return "\n".join([*_measures(), *_units()])


def _measures() -> Iterator[str]:
    yield "## All measures\n"
    yield (
        "Every evaluation records the measures below. A measure with ¹ is recorded where a "
        "spec names it, as a descriptor or in a container; ² where a gait is swept; ³ is no "
        "measure of a motion and is shown beside them. A descriptor has the ends and scale "
        "given here unless the spec has others.\n"
    )
    notes = {"always": "", "named": " ¹", "gaits": " ²", "never": " ³"}
    for group, title in GROUPS.items():
        yield f"### {title}\n"
        yield "| name | title | unit | axis | scale | |"
        yield "|---|---|---|---|---|---|"
        for name, one in MEASURES.items():
            if one.group == group:
                axis = f"{one.low:g} to {one.high:g}"
                row = (f"`{name}`{notes[one.recorded]}", one.title, one.unit or "1", axis)
                yield "| " + " | ".join((*row, one.scale, one.about)) + " |"
        yield ""


def _units() -> Iterator[str]:
    yield "## Units\n"
    yield (
        "A cell of x metres, a step of t seconds, a body of ℓ metres and a stroke of τ seconds "
        "turn the units of the lattice into SI units. The fluid is a sheet, and neither its "
        "density nor its depth is given: a cell has the mass 1 in the lattice, and x² times "
        "both in kg.\n"
    )
    yield "| unit | SI | factor | measures |"
    yield "|---|---|---|---|"
    for unit, one in UNITS.items():
        names = ", ".join(f"`{name}`" for name, each in MEASURES.items() if each.unit == unit)
        if names:
            about = one.about.replace(", ", ": ", 1)
            yield f"| {unit} | {one.si} | {one.formula} | {names}{about} |"
    yield ""
