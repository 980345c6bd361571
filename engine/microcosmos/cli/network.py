"""The command `network`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .app import app, fail

if TYPE_CHECKING:
    from ..viz.networks import Network

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
            from ..archive.atomic import write_whole

            write_whole(out, data)
            print(out)
    except (ValueError, OSError) as error:
        fail(f"{file}: {error}")


def _read(file: Path) -> "Network":
    from ..archive.creature import parse
    from ..viz.networks import load_tensorneat, of_creature

    data = file.read_bytes()
    if data[:2] == ZIP:
        return load_tensorneat(data)[0]
    return of_creature(parse(data)["identity"])


def _rendered(network: "Network", form: str) -> bytes:
    from ..viz import networks

    if form == "tensorneat":
        return networks.dump_tensorneat(networks.write_tensorneat(network))
    texts = {
        "svg": networks.svg,
        "dot": networks.dot,
        "python": networks.numpy_code,
        "formula": networks.formula,
    }
    return texts[form](network).encode()
