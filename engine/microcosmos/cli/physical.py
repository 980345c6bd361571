"""The command `units`: physical units of a creature or of an archive."""

import csv
import sys
from collections.abc import Iterable, Mapping, Sequence
from io import StringIO
from json import dumps, loads
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from ..archive import creature_h5
from ..archive.atomic import write_whole
from ..archive.quantities import shown
from .app import app, failing
from .remote import Json

Length = Annotated[str, Option("--length", help="Real length of the body, such as 1mm.")]
Period = Annotated[str, Option("--period", help="Real period of a stroke, such as 0.5s.")]

TITLES = {
    "reynolds": "Reynolds number",
    "strouhal": "Strouhal number",
    "sperm": "sperm number",
    "mach": "Mach number",
}


@app.command()
def units(
    file: Annotated[
        Path, Argument(exists=True, dir_okay=False, help="A creature file, or a run's archive.")
    ],
    length: Length,
    period: Period,
    out: Annotated[
        Path | None, Option(help="File to write to, CSV or with --json JSON; default: print.")
    ] = None,
    json: Json = False,
) -> None:
    """Print physical units, given the real length of a body and the period of its stroke."""
    from ..viz import physical  # Loads SciPy.

    with failing(file):
        data = file.read_bytes()
        if creature_h5.is_of_run(data):
            _, columns = physical.of_archive(data, length, period)
            rows = _rows({name: column.tolist() for name, column in columns.items()})
            _write(_json(rows) if json else _csv(columns, rows), out)
            return
        found, numbers = physical.of_creature(creature_h5.read(data), length, period)
        row = {"cell_m": found.scales.cell, "step_s": found.scales.step} | numbers
        if json:
            _write(_json(row), out)
        elif out:
            _write(_csv(row, [row]), out)
        else:
            print(found.sentence())
            _print_numbers(numbers)


def _print_numbers(numbers: Mapping[str, float]) -> None:
    for name, value in (
        ("speed", "speed_m_per_s"),
        ("speed of the nodes", "node_speed_m_per_s"),
    ):
        if value in numbers:
            print(f"{name:>20}  {shown(numbers[value], 'm/s')}")
    for name, title in TITLES.items():
        if name in numbers:
            print(f"{title:>20}  {numbers[name]:.3g}")


def _rows(columns: Mapping[str, list[Any]]) -> list[dict[str, Any]]:
    values = zip(*columns.values(), strict=True)
    return [dict(zip(columns, row, strict=True)) for row in values]


def _json(document: Any) -> str:
    """Return JSON, which has null and no NaN."""
    finite = loads(dumps(document), parse_constant=lambda _: None)
    return f"{dumps(finite, indent=1)}\n"


def _csv(names: Iterable[str], rows: Sequence[Mapping[str, Any]]) -> str:
    text = StringIO()
    writer = csv.DictWriter(text, list(names), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _write(text: str, out: Path | None) -> None:
    if out is None:
        sys.stdout.write(text)
    else:
        write_whole(out, text.encode())
        print(out)
