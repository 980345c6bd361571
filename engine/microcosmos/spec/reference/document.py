"""The reference of every field of a spec, generated from the schemas: `docs/spec.md`."""

from collections.abc import Iterator
from typing import Any

from ..experiments import EXPERIMENTS, Experiment
from ..measures import MEASURES
from .fields import Field, Part, experiment, parts

HEAD = """# Every field of a spec

A spec is a JSON object with an `experiment`. A field that is left out has its default, and an
unknown field is refused. Lengths are in cells and times in steps of the lattice, whose density
is 1 at rest; a field without a unit has none. The range (a, b) excludes its ends, [a, b]
includes them. The source names the origin of the method; *Tensen et al. 2026* is the
Microcosmos paper, with which [reproduction.md](reproduction.md) compares each value. This page
is generated: `python -m microcosmos.spec.reference > docs/spec.md`.
"""

COLUMNS = ("field", "type", "unit", "range", "default", "meaning", "source")


def reference() -> str:
    """Return the whole document."""
    found = list(EXPERIMENTS.values())
    return "\n".join(
        [
            HEAD,
            *_contents(),
            *(line for one in found for line in _experiment(one)),
            "## Parts\n",
            *(line for part in parts() for line in _part(part)),
            *_measures(),
        ]
    )


def _contents() -> Iterator[str]:
    experiments = ", ".join(f"[`{name}`](#{name})" for name in EXPERIMENTS)
    found = ", ".join(f"[{part.name}](#{part.name.lower()})" for part in parts())
    yield f"Experiments: {experiments}.\n"
    yield f"Parts: {found}. The numbers that every evaluation records: [measures](#measures).\n"
    yield "## Experiments\n"


def _experiment(chosen: Experiment) -> Iterator[str]:
    yield f"### {chosen.name}\n"
    yield f"{chosen.title}. {experiment(chosen.name).text}\n"
    yield from _table(experiment(chosen.name).fields)
    if chosen.presets:
        yield "Presets: " + "; ".join(f"`{p.name}`: {p.title}" for p in chosen.presets) + ".\n"


def _part(part: Part) -> Iterator[str]:
    yield f"### {part.name}\n"
    yield part.text + (f" *Source: {part.source}.*" if part.source else "") + "\n"
    yield f"Used at {', '.join(f'`{path}`' for path in part.paths)}.\n"
    yield from _table(part.fields)


def _table(fields: tuple[Field, ...]) -> Iterator[str]:
    yield _row(COLUMNS)
    yield _row(["---"] * len(COLUMNS))
    for field in fields:
        yield _row((f"`{field.name}`", *field[1:]))
    yield ""


def _measures() -> Iterator[str]:
    yield "## Measures\n"
    yield (
        "Every evaluation records these measures. A measure makes the axis below unless `low`, "
        "`high` and `scale` of its [Descriptor](#descriptor) change it.\n"
    )
    yield _row(("name", "title", "unit", "low", "high", "scale"))
    yield _row(["---"] * 6)
    for name, one in MEASURES.items():
        yield _row(
            (f"`{name}`", one.title, one.unit, f"{one.low:g}", f"{one.high:g}", one.scale)
        )
    yield ""


def _row(values: Any) -> str:
    return "| " + " | ".join(str(value).replace("|", "\\|") for value in values) + " |"
