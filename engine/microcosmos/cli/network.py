"""The command `network`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from ..archive.atomic import write_whole
from ..archive.creature import parse
from ..viz import networks
from ..viz.networks import Network, load_tensorneat, of_creature
from .app import app, fail

ZIP = b"PK"
"""The first bytes of a TensorNEAT genome."""


@app.command()
def network(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    svg: Annotated[bool, typer.Option("--svg", help="Draw a picture.")] = False,
    dot: Annotated[bool, typer.Option("--dot", help="Write a graph for Graphviz.")] = False,
    python: Annotated[
        bool, typer.Option("--python", help="Write a Python module that uses NumPy.")
    ] = False,
    formula: Annotated[bool, typer.Option("--formula", help="Print formulas.")] = False,
    tensorneat: Annotated[
        bool,
        typer.Option(
            "--tensorneat", help="Write a TensorNEAT genome (.npz), see docs/networks.md."
        ),
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="File to write; default: standard output.")
    ] = None,
) -> None:
    """Write the network of a creature file or of a TensorNEAT genome in one form."""
    forms = {
        "svg": svg,
        "dot": dot,
        "python": python,
        "formula": formula,
        "tensorneat": tensorneat,
    }
    chosen = [name for name, wanted in forms.items() if wanted] or ["formula"]
    if len(chosen) > 1:
        fail(f"network takes one form, got --{' --'.join(chosen)}")
    try:
        data = _rendered(_read(file), chosen[0])
        if out is None:
            sys.stdout.buffer.write(data)
        else:
            write_whole(out, data)
            print(out)
    except (ValueError, OSError) as error:
        fail(f"{file}: {error}")


def _read(file: Path) -> "Network":
    data = file.read_bytes()
    if data[:2] == ZIP:
        return load_tensorneat(data)[0]
    return of_creature(parse(data)["identity"])


def _rendered(network: "Network", form: str) -> bytes:
    if form == "tensorneat":
        return networks.dump_tensorneat(networks.write_tensorneat(network))
    texts = {
        "svg": networks.svg,
        "dot": networks.dot,
        "python": networks.numpy_code,
        "formula": networks.formula,
    }
    return texts[form](network).encode()
