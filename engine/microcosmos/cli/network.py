"""The command `network`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from ..archive.atomic import write_whole
from ..archive.creature import parse
from ..viz import networks
from .app import CreaturePath, app, fail, failing

ZIP = b"PK"
"""The first bytes of a TensorNEAT genome."""
TEXTS = {
    "svg": networks.svg,
    "dot": networks.dot,
    "python": networks.numpy_code,
    "formula": networks.formula,
}


@app.command()
def network(
    file: CreaturePath,
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
    forms = (*zip(TEXTS, (svg, dot, python, formula), strict=True), ("tensorneat", tensorneat))
    chosen = [name for name, wanted in forms if wanted] or ["formula"]
    if len(chosen) > 1:
        fail(f"network takes one form, got --{' --'.join(chosen)}")
    with failing(file):
        data = _rendered(file.read_bytes(), chosen[0])
        if out is None:
            sys.stdout.buffer.write(data)
        else:
            write_whole(out, data)
            print(out)


def _rendered(data: bytes, form: str) -> bytes:
    if data[:2] == ZIP:
        network = networks.load_tensorneat(data)[0]
    else:
        network = networks.of_creature(parse(data)["identity"])
    if form == "tensorneat":
        return networks.dump_tensorneat(networks.write_tensorneat(network))
    return TEXTS[form](network).encode()
