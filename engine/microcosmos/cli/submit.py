"""Submitting runs and sweeps to a server."""

from typing import Annotated, Any

import typer

from ..client import Client, Run, Sweep, specs
from . import overrides
from .app import app
from .monitor import ended
from .remote import RUNS, Json, Token, Url, reaching, say, show

Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="FIELD=VALUE",
        help="Set a field, such as world.viscosity=0.1; repeatable.",
    ),
]
Name = Annotated[str | None, typer.Option(help="Name of the run.")]
Watch = Annotated[bool, typer.Option("--watch", "-w", help="Watch until it ends.")]


@app.command(rich_help_panel=RUNS)
def submit(
    spec: Annotated[str, typer.Argument(help="Spec file, or name of a preset.")],
    seeds: Annotated[
        int | None, typer.Option(min=1, help="Queue a sweep with this number of seeds.")
    ] = None,
    settings: Set = None,
    grid: Annotated[
        list[str] | None,
        typer.Option(
            "--sweep",
            metavar="FIELD=A,B,...",
            help="Queue a run for each value of a field; several fields make a grid.",
        ),
    ] = None,
    name: Name = None,
    watch: Watch = False,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Queue a run or a sweep, and print its id."""
    with reaching(url, token) as client:
        made = _submitted(client, spec, seeds, settings or [], overrides.grid(grid or []), name)
        tell(made, json)
        if watch:
            raise typer.Exit(ended(made))


def _submitted(
    client: "Client",
    spec: str,
    seeds: int | None,
    settings: list[str],
    grid: dict[str, list[Any]],
    name: str | None,
) -> "Run | Sweep":
    document = overrides.applied(specs.document(client.connection, spec), settings)
    if seeds is None and not grid:
        return client.submit(document, name=name)
    return client.submit(document, seeds=seeds or 1, grid=grid, name=name)


def tell(made: "Run | Sweep", json: bool) -> None:
    """The id for scripts, and for people where to look."""
    if json:
        show(made.record)
        return
    print(made.id, flush=True)
    if "cases" in made.record:
        say(f"A sweep of {made.record['total']} runs; to watch it: {_watching(made)}")
    else:
        say(f"{made.record['status']}; to watch it: {_watching(made)}")


def _watching(made: "Run | Sweep") -> str:
    return f"microcosmos watch {made.id[:8]}"
