"""Options and output of all commands that use a server."""

import json
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Annotated, Any

import typer
from rich.console import Console

from ..client import Client, NotFound, Refused, Run, ServerError, Sweep
from .app import console

RUNS = "Runs on a server"
SHARING = "Sharing and access"
SERVER = "Server"
WIDE = 200
"""Width of a table that is not written to a terminal."""

Url = Annotated[
    str | None,
    typer.Option(
        envvar="MICROCOSMOS_URL",
        help="Address of the server.",
        show_default="http://127.0.0.1:8000",
        rich_help_panel=SERVER,
    ),
]
Token = Annotated[
    str | None,
    typer.Option(
        envvar="MICROCOSMOS_TOKEN",
        help="Access token, if the server requires one.",
        rich_help_panel=SERVER,
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the full record as JSON.")]
Id = Annotated[str, typer.Argument(metavar="ID", help="Id; its first characters are enough.")]
Ids = Annotated[
    list[str], typer.Argument(metavar="ID...", help="Ids; their first characters are enough.")
]


@contextmanager
def reaching(url: str | None, token: str | None) -> Iterator["Client"]:
    """Yield a client; print a failure to standard error and exit with status 1."""
    try:
        with Client(url, token) as client:
            yield client
    except (ServerError, ValueError, OSError) as error:
        say(str(error), "red")
        raise typer.Exit(1) from None
    except KeyboardInterrupt:
        raise typer.Exit(130) from None


def say(text: str, style: str | None = None) -> None:
    """Print to standard error, for people; lines are not wrapped."""
    console.print(text, style=style, markup=False, highlight=False, soft_wrap=True)


def show(document: Any) -> None:
    """Print JSON to standard output, for scripts."""
    print(json.dumps(document, indent=1, ensure_ascii=False))


def stdout() -> Console:
    return Console() if sys.stdout.isatty() else Console(width=WIDE)


def found(client: "Client", id: str, deleted: bool = False) -> "Run | Sweep":
    """The run or the sweep of an id, in the bin where they are `deleted`.

    Raises `NotFound`, and `Refused` where the id begins one of each.
    """
    both: list[Run | Sweep] = []
    for look in (client.run, client.sweep):
        with suppress(NotFound):
            both.append(look(id, deleted=deleted))
        if both and both[0].id == id.strip().lower():
            break
    if not both:
        raise NotFound(f"No run or sweep at {client.url} has an id that begins with {id}.")
    if len(both) > 1:
        run, sweep = both
        raise Refused(f"{id} is the beginning of run {run.id} and of sweep {sweep.id}.")
    return both[0]


def about(thing: "Run | Sweep") -> str:
    """Name a run or a sweep with its status."""
    record = thing.record
    if "cases" in record:
        counts = record["status_counts"].items()
        status = ", ".join(f"{count} {name}" for name, count in counts if count)
    else:
        requested = record.get("requested_state")
        status = record["status"] + (f", to be {requested}" if requested else "")
    return f"{title(thing)}: {status}"


def title(thing: "Run | Sweep") -> str:
    return f"{type(thing).__name__} {named(thing.record)}"


def named(run: Mapping[str, Any]) -> str:
    """Return the short id and the name of a run."""
    return run["id"][:8] + (f" “{run['name']}”" if run.get("name") else "")
