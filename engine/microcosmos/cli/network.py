"""The command `network`."""

import sys
from pathlib import Path
from typing import Annotated

from typer import Option

from ..archive.atomic import write_whole
from ..archive.creature import parse
from ..viz import networks
from .app import CreaturePath, app, fail, failing

ZIP = b"PK"
"""The first bytes of a TensorNEAT genome."""
TEXTS = {
    "formula": networks.formula,
    "svg": networks.svg,
    "dot": networks.dot,
    "python": networks.numpy_code,
}


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


def _rendered(data: bytes, form: str) -> bytes:
    if data[:2] == ZIP:
        network = networks.load_tensorneat(data)[0]
    else:
        network = networks.of_creature(parse(data)["identity"])
    if form == "tensorneat":
        return networks.dump_tensorneat(networks.write_tensorneat(network))
    return TEXTS[form](network).encode()
