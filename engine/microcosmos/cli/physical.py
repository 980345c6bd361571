"""The command `units`: physical units of a creature or of an archive."""

import csv
import sys
from io import StringIO
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from ..archive.atomic import write_whole
from ..archive.file import HDF5
from ..archive.quantities import shown
from .app import app, failing
from .remote import Json, show

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
        Path | None, Option(help="File for the table of an archive, as CSV; default: print.")
    ] = None,
    json: Json = False,
) -> None:
    """Print physical units, given the real length of a body and the period of its stroke."""
    from ..viz import physical  # Loads SciPy.

    with failing(file):
        data = file.read_bytes()
        if data.startswith(HDF5) and file.suffix == ".h5":
            _, columns = physical.of_archive(data, length, period)
            _write(_csv(columns), out)
            return
        found, numbers = physical.of_creature(data, length, period)
    if json:
        show({"cell_m": found.scales.cell, "step_s": found.scales.step} | numbers)
        return
    print(found.sentence())
    for name, value in (
        ("speed", "speed_m_per_s"),
        ("speed of the nodes", "node_speed_m_per_s"),
    ):
        if value in numbers:
            print(f"{name:>20}  {shown(numbers[value], 'm/s')}")
    for name, title in TITLES.items():
        if name in numbers:
            print(f"{title:>20}  {numbers[name]:.3g}")


def _csv(columns: dict[str, Any]) -> str:
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    return text.getvalue()


def _write(text: str, out: Path | None) -> None:
    if out is None:
        sys.stdout.write(text)
    else:
        write_whole(out, text.encode())
        print(out)
