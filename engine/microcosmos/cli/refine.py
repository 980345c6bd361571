"""The command `refine`."""

import json
from pathlib import Path
from typing import Annotated

import typer
from pydantic import ValidationError

from ..archive.creature import CreatureError, parse
from ..archive.table import read_table
from ..spec import Archive, Refinement
from .app import CACHE, app, console, fail
from .modules import Modules, load_modules
from .run import carry_on, evaluations_of
from .specs import read_spec, said


@app.command()
def refine(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    like: Annotated[
        str | None,
        typer.Option(
            help="Spec or preset whose archive cells bound the search; default: 20 × 20 cells."
        ),
    ] = None,
    steps: Annotated[int, typer.Option(min=1)] = 20,
    length: Annotated[float, typer.Option(help="Length of the first step.")] = 0.2,
    out: Annotated[
        Path | None, typer.Option(help="Archive file; default: NAME.refined.h5.")
    ] = None,
    segment: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Simulation steps whose states the gradient keeps in memory; default: all.",
        ),
    ] = None,
    other_device: Annotated[
        bool, typer.Option(help="Continue a run that another kind of device started.")
    ] = False,
    module: Modules = None,
) -> None:
    """Improve a creature by gradient steps that stay in its cell."""
    load_modules(module)
    path = out or file.with_name(f"{file.name.removesuffix('.json')}.refined.h5")
    try:
        creature = parse(file.read_bytes())
        chosen = Refinement(
            creature=creature,
            archive=_archive(like),
            steps=steps,
            length=length,
            segment=segment,
        )
    except (CreatureError, OSError) as error:
        fail(f"{file}: {error}")
    except ValidationError as error:
        fail("\n".join(f"{file}: {said(found)}" for found in error.errors()))
    evaluations_of(chosen, path)
    from ..device import prepare

    prepare(cache=CACHE)
    if not carry_on(chosen, path, 60.0, other_device):
        console.print(f"Stopped. The same command goes on from {path}.")
        raise typer.Exit(130)
    _tell(path)


def _archive(like: str | None) -> Archive:
    if like is None:
        return Archive()
    found = getattr(read_spec(like), "archive", None)
    if found is None:
        fail(f"--like needs a spec with an archive, got {like}")
    return found


def _tell(path: Path) -> None:
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
