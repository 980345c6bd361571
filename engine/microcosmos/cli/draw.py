"""Pictures, films and figures."""

from pathlib import Path
from typing import Annotated

import typer

from .app import CACHE, app, fail
from .modules import Modules, load_modules

HDF5 = b"\x89HDF\r\n\x1a\n"
"""How such a file begins."""


@app.command()
def figure(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    out: Annotated[
        Path,
        typer.Argument(help=".png, .gif or .mp4 of a creature; .png, .svg or .pdf of a run."),
    ],
    module: Modules = None,
) -> None:
    """A picture or a film of a creature or its replay; the figure of a run with a table."""
    load_modules(module)
    try:
        _draw(file, out)
    except (ValueError, RuntimeError, ImportError, OSError) as error:
        fail(f"{file}: {error}")
    print(out)


def _draw(file: Path, out: Path) -> None:
    """A creature file is simulated first; the file of a run holds its table."""
    data = file.read_bytes()
    if data[:8] == HDF5:
        from ..render import figures

        figures.save(figures.of(data), out)
        return
    from ..render import export

    if data[:1] == b"{":
        from ..archive.creature import parse
        from ..device import prepare
        from ..render import record

        prepare(cache=CACHE)
        data = record(parse(data))
    export(data, out)
