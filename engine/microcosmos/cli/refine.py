"""The command `refine`."""

import json
from pathlib import Path
from typing import Annotated

from typer import Option

from ..archive.creature import parse
from ..archive.file import read_table
from ..spec import Archive, Refinement
from .app import CreaturePath, OtherDevice, app, fail, failing
from .modules import Modules, load_modules
from .run import carry_on, prepare_run
from .specs import read_spec


@app.command()
def refine(
    file: CreaturePath,
    like: Annotated[
        str | None,
        Option(
            help="Spec or preset whose archive cells bound the search; default: 20 × 20 cells."
        ),
    ] = None,
    steps: Annotated[int, Option(min=1, help="Number of steps.")] = 20,
    length: Annotated[float, Option(help="Length of the first step.")] = 0.2,
    out: Annotated[Path | None, Option(help="Archive file; default: NAME.refined.h5.")] = None,
    segment: Annotated[
        int | None,
        Option(
            min=1,
            help="Simulation steps whose states the gradient keeps in memory; default: all.",
        ),
    ] = None,
    other_device: OtherDevice = False,
    module: Modules = None,
) -> None:
    """Improve a creature by gradient steps that stay in its cell."""
    load_modules(module)
    path = out or file.with_name(f"{file.name.removesuffix('.json')}.refined.h5")
    with failing(file):
        spec = Refinement(
            creature=parse(file.read_bytes()),
            archive=_archive(like),
            steps=steps,
            length=length,
            segment=segment,
        )
    prepare_run(spec, path)
    carry_on(spec, path, 60.0, other_device)
    _print_comparison(path)


def _archive(like: str | None) -> Archive:
    if like is None:
        return Archive()
    found = getattr(read_spec(like), "archive", None)
    if found is None:
        fail(f"--like needs a spec with an archive, got {like}")
    return found


def _print_comparison(path: Path) -> None:
    """Print the creature before and after the refinement."""
    rows = read_table(path.read_bytes()).rows
    before, after = rows[0], rows[-1]
    print(f"{'':>20}  {'before':>12}  {'after':>12}")
    for name in before:
        if before[name] is not None and name != "step":
            print(f"{name:>20}  {before[name]:>12.6g}  {after[name]:>12.6g}")
    best = path.with_suffix(".best.json")
    name = json.loads(best.read_bytes())["sha256"][:12]
    print(f"{len(rows) - 1} steps into {path}; the creature {name}: {best}")
