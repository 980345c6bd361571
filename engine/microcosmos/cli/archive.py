"""The command `variety` for archive files."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from typer import Argument

from ..archive.variety import KIND, of
from .app import app, failing
from .remote import Json, show


@app.command()
def variety(
    file: Annotated[
        Path, Argument(exists=True, dir_okay=False, help="The archive file of a search.")
    ],
    json: Json = False,
) -> None:
    """Print how far the motions of the elites are from each other."""
    with failing(file):
        found = of(file.read_bytes())
    if json:
        show(asdict(found))
        return
    sampled = f", {found.compared} of them compared" if found.compared < found.creatures else ""
    print(f"{found.creatures} elites{sampled}; distances in body lengths")
    for name, value, of_what in (
        ("motion distance", f"{found.motion_distance:.4f}", "mean over pairs"),
        ("nearest motion", f"{found.nearest_motion:.4f}", "median over elites"),
        ("motion alone", f"{found.motion_alone:.4f}", "mean over pairs, less mean poses"),
        ("kinds of motion", f"{found.kinds}", f"more than {KIND} apart"),
    ):
        print(f"{name:>15}  {value:>6}  {of_what}")
