"""Commands for creature files: replay, audit, gradient, network."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from typer import Option

from ..archive.atomic import write_whole
from ..archive.beside import beside
from ..archive.creature_h5 import read
from ..viz import networks
from .app import CreaturePath, app, fail, failing
from .modules import Modules, prepare_engine

Report = Annotated[Path | None, Option(help="File to write the report to, as JSON.")]
ZIP = b"PK"
"""The first bytes of a TensorNEAT genome."""
TEXTS = {
    "formula": networks.formula,
    "svg": networks.svg,
    "dot": networks.dot,
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
    prepare_engine(module)
    from ..viz.replay import record

    with failing(file):
        creature = read(file.read_bytes())
        if check:
            _check(creature)
        else:
            out = out or beside(file, ".replay")
            write_whole(out, record(creature))
            print(out)


@app.command()
def audit(file: CreaturePath, out: Report = None, module: Modules = None) -> None:
    """Audit the physics of a creature: is its swimming the same on a finer grid?"""
    prepare_engine(module)
    from ..audit.physics import audit as examine

    with failing(file):
        found = examine(read(file.read_bytes()))
        _write(out, found)
    _print_audit(found)
    if not found["verdict"]["trusted"]:
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
    prepare_engine(module)
    from ..audit.derivatives import report_gradient

    with failing(file):
        parts = tuple(by or ["genes"])
        found = report_gradient(read(file.read_bytes()), of, parts, starts=starts)
        _write(out, found.document())
    for line in found.lines():
        print(line)


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
    if form not in (*TEXTS, "tensorneat"):
        fail(f"--as must be one of {', '.join(TEXTS)}, tensorneat; got {form}")
    with failing(file):
        data = _rendered(file.read_bytes(), form)
        if out is None:
            sys.stdout.buffer.write(data)
        else:
            write_whole(out, data)
            print(out)


def _write(out: Path | None, report: Mapping[str, Any]) -> None:
    if out:
        write_whole(out, json.dumps(report, indent=1).encode())


def _check(creature: dict[str, Any]) -> None:
    from ..audit.reproducibility import check

    result = check(creature)
    for name, repeated in result.repeated.items():
        recorded = result.recorded.get(name, float("nan"))
        print(f"{name:>18}  recorded {recorded:.9g}  repeated {repeated:.9g}")
    if result.exact:
        print("The same, bit for bit.")
        return
    reason = "" if result.same_device else ": it was measured on another kind of device"
    print(f"Not the same{reason}.")
    raise typer.Exit(1)


def _print_audit(found: Mapping[str, Any]) -> None:
    for row in found["rows"]:
        mark = {True: "pass", False: "FAIL", None: "    "}[row["passed"]]
        value = "none" if row["value"] is None else f"{row['value']:.4g} {row['unit']}"
        bar = f"  ({row['bar']})" if row["bar"] else ""
        print(f"{mark}  {row['quantity']}: {value.strip()}{bar}")
    print("Trusted." if found["verdict"]["trusted"] else "Not trusted:")
    for reason in found["verdict"]["reasons"]:
        print(f"  {reason}")


def _rendered(data: bytes, form: str) -> bytes:
    if data[:2] == ZIP:
        network = networks.load_tensorneat(data)[0]
    else:
        network = networks.of_creature(read(data)["identity"])
    if form == "tensorneat":
        return networks.dump_tensorneat(networks.write_tensorneat(network))
    return TEXTS[form](network).encode()
