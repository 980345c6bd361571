"""Commands for creature and archive files: replay, audit, gradient, network, units, variety."""

from collections.abc import Mapping
from dataclasses import asdict
from json import dumps, loads
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from typer import Argument, Option

from .. import networks
from ..archive import creature_h5
from ..archive.atomic import write_whole
from ..archive.creature_h5 import read
from ..archive.export import as_csv
from ..archive.file_names import beside
from ..archive.variety import KIND, of
from ..measures import MEASURES
from ..quantities import files
from ..quantities.real import shown
from ..viz import networks as pictures
from .app import (
    CreaturePath,
    Modules,
    app,
    deliver,
    fail,
    failing,
    prepare_engine,
    refuse_input,
)
from .remote import Json, show

Report = Annotated[Path | None, Option(help="File to write the report to, as JSON.")]
ZIP = b"PK"
"""The first bytes of a TensorNEAT genome."""
TEXTS = {
    "formula": networks.formula,
    "svg": pictures.svg,
    "dot": pictures.dot,
    "python": networks.numpy_code,
}


@app.command()
def replay(
    file: CreaturePath,
    check: Annotated[
        bool, Option("--check", help="Evaluate again and compare bit for bit.")
    ] = False,
    out: Annotated[Path | None, Option(help="File to write the replay to.")] = None,
    module: Modules = None,
) -> None:
    """Simulate a creature file again."""
    out = out or beside(file, ".replay")
    if not check:
        refuse_input(out, file)
    prepare_engine(module)
    from ..viz.replay import record

    with failing(file):
        creature = read(file.read_bytes())
        if check:
            _check(creature)
        else:
            deliver(record(creature), out)


@app.command()
def audit(file: CreaturePath, out: Report = None, module: Modules = None) -> None:
    """Audit the physics of a creature: is its swimming the same on a finer grid?"""
    refuse_input(out, file)
    prepare_engine(module)
    from ..audit.physics import audit as examine

    with failing(file):
        report = examine(read(file.read_bytes()))
    _print_audit(report)
    _write(out, report)
    if not report["verdict"]["trusted"]:
        raise typer.Exit(1)


@app.command()
def gradient(
    file: CreaturePath,
    of: Annotated[str, Option(help="fitness, or a measure.")] = "fitness",
    by: Annotated[
        list[str] | None,
        Option(help="genes (default), rest_angle, stretch, segment_curl, viscosity …"),
    ] = None,
    starts: Annotated[int, Option(min=1, help="Number of other starts to compare with.")] = 8,
    out: Report = None,
    module: Modules = None,
) -> None:
    """Measure how far the gradient of a creature's fitness or of a measure can be trusted."""
    refuse_input(out, file)
    prepare_engine(module)
    from ..audit.derivatives import report_gradient

    with failing(file):
        parts = tuple(by or ["genes"])
        report = report_gradient(read(file.read_bytes()), of, parts, starts=starts)
    for line in report.lines():
        print(line)
    _write(out, report.document())


@app.command()
def network(
    file: CreaturePath,
    form: Annotated[
        str,
        Option(
            "--as",
            help="formula, svg, dot (for Graphviz), python (with NumPy), or tensorneat (.npz).",
        ),
    ] = "formula",
    out: Annotated[Path | None, Option(help="File to write; default: standard output.")] = None,
) -> None:
    """Write the network of a creature file or of a TensorNEAT genome."""
    refuse_input(out, file)
    if form not in (*TEXTS, "tensorneat"):
        fail(f"--as must be one of {', '.join(TEXTS)}, tensorneat; got {form}")
    with failing(file):
        deliver(_rendered(file.read_bytes(), form), out)


def _write(out: Path | None, report: Mapping[str, Any]) -> None:
    # Last: a file that cannot be written costs no result, which may have taken minutes.
    if out:
        with failing("--out"):
            write_whole(out, _json(report))


def _check(creature: dict[str, Any]) -> None:
    from ..audit.reproducibility import check

    result = check(creature)
    recorded = {"fitness": result.fitness[0]} | result.recorded
    for name, repeated in ({"fitness": result.fitness[1]} | result.repeated).items():
        known = f"{recorded[name]:.9g}" if name in recorded else "nothing"
        print(f"{name:>18}  recorded {known}  repeated {repeated:.9g}")
    if result.missing:
        print(f"The file lacks {len(result.missing)} of {len(result.repeated)} measures.")
    if result.exact:
        print("The same, bit for bit.")
        return
    reason = "" if result.same_device else ": it was measured on another kind of device"
    print(f"Not the same{reason}.")
    raise typer.Exit(1)


def _print_audit(report: Mapping[str, Any]) -> None:
    for row in report["rows"]:
        mark = {True: "pass", False: "FAIL", None: "    "}[row["passed"]]
        value = "none" if row["value"] is None else f"{row['value']:.4g} {row['unit']}"
        bar = f"  ({row['bar']})" if row["bar"] else ""
        print(f"{mark}  {row['quantity']}: {value.strip()}{bar}")
    print("Trusted." if report["verdict"]["trusted"] else "Not trusted:")
    for reason in report["verdict"]["reasons"]:
        print(f"  {reason}")


def _rendered(data: bytes, form: str) -> bytes:
    if data[:2] == ZIP:
        network = networks.load_tensorneat(data)[0]
    else:
        network = networks.of_creature(read(data)["identity"])
    if form == "tensorneat":
        return networks.dump_tensorneat(networks.write_tensorneat(network))
    return TEXTS[form](network).encode()


Length = Annotated[str, Option("--length", help="Real length of the body, such as 1mm.")]
Period = Annotated[str, Option("--period", help="Real period of a stroke, such as 0.5s.")]

PLAIN = ("reynolds", "strouhal", "sperm", "mach")
"""Numbers without a unit, as they are printed."""


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
    refuse_input(out, file)
    with failing(file):
        data = file.read_bytes()
        if creature_h5.is_of_run(data):
            _, columns = files.of_archive(data, length, period)
            deliver(_json(_rows(columns)) if json else as_csv(dict(columns)).encode(), out)
            return
        found, numbers = files.of_creature(creature_h5.read(data), length, period)
        row = {"cell_m": found.scales.cell, "step_s": found.scales.step} | numbers
        if json:
            deliver(_json(row), out)
        elif out:
            deliver(as_csv({name: [value] for name, value in row.items()}).encode(), out)
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
    for name in PLAIN:
        if name in numbers:
            print(f"{MEASURES[name].title:>20}  {numbers[name]:.3g}")


def _rows(columns: Mapping[str, np.ndarray]) -> list[dict[str, Any]]:
    values = zip(*(column.tolist() for column in columns.values()), strict=True)
    return [dict(zip(columns, row, strict=True)) for row in values]


def _json(document: Any) -> bytes:
    """Return JSON, which has null and no NaN."""
    finite = loads(dumps(document), parse_constant=lambda _: None)
    return f"{dumps(finite, indent=1)}\n".encode()


@app.command()
def variety(
    file: Annotated[
        Path, Argument(exists=True, dir_okay=False, help="The archive file of a search.")
    ],
    json: Json = False,
) -> None:
    """Print how far the motions of the elites are from each other."""
    with failing(file):
        measured = of(file.read_bytes())
    if json:
        show(asdict(measured))
        return
    sampled = (
        f", {measured.compared} of them compared"
        if measured.compared < measured.creatures
        else ""
    )
    print(f"{measured.creatures} elites{sampled}; distances in body lengths")
    for name, value, of_what in (
        ("motion distance", f"{measured.motion_distance:.4f}", "mean over pairs"),
        ("nearest motion", f"{measured.nearest_motion:.4f}", "median over elites"),
        ("motion alone", f"{measured.motion_alone:.4f}", "mean over pairs, less mean poses"),
        ("kinds of motion", f"{measured.kinds}", f"more than {KIND} apart"),
    ):
        print(f"{name:>15}  {value:>6}  {of_what}")
