"""Options and output of all commands that use a server."""

import json
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from functools import cache
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Column, Table
from rich.text import Text
from typer import Argument, Option

from ..client import Client, NotFound, Refused, Run, ServerError, Sweep
from ..client.formatting import counts_as_text, quoted, status_of, visible, visible_lines
from .app import app, say, with_options

RUNS = "Runs on a server"
SHARING = "Sharing and access"
SERVER = "Server"
WIDE = 200
"""Width of a table that is not written to a terminal."""

Url = Annotated[
    str | None,
    Option(
        envvar="MICROCOSMOS_URL",
        help="Address of the server.",
        show_default="http://127.0.0.1:8000",
        rich_help_panel=SERVER,
    ),
]
Token = Annotated[
    str | None,
    Option(
        envvar="MICROCOSMOS_TOKEN",
        help="Access token, if the server requires one.",
        rich_help_panel=SERVER,
    ),
]
Json = Annotated[bool, Option("--json", help="Print the full record as JSON.")]
Id = Annotated[str, Argument(metavar="ID", help="Id; its first characters are enough.")]
Ids = Annotated[
    list[str], Argument(metavar="ID...", help="Ids; their first characters are enough.")
]


@contextmanager
def connecting(url: Url = None, token: Token = None) -> Iterator[Callable[[], Client]]:
    """Yield a function that returns a client: a command for files may need none.

    Print a failure to standard error and exit with status 1.
    """
    try:
        with ExitStack() as stack:
            yield cache(lambda: stack.enter_context(Client(url, token)))
    except BrokenPipeError:  # The reader of the output has seen enough: Click ends quietly.
        raise
    except (ServerError, ValueError, OSError, ImportError) as error:
        say(str(error), "red")
        raise typer.Exit(1) from None
    except KeyboardInterrupt:
        # The status of shells for Ctrl-C: 128 + SIGINT.
        raise typer.Exit(130) from None


@contextmanager
def _connected(url: Url = None, token: Token = None) -> Iterator[Client]:
    with connecting(url, token) as connect:
        yield connect()


def server_command(
    panel: str | None = None,
    name: str | None = None,
    group: typer.Typer = app,
    make: Callable[..., AbstractContextManager[Any]] = _connected,
) -> Callable[[Callable[..., None]], None]:
    """Register a command that gets a client and the options --url and --token."""

    def register(command: Callable[..., None]) -> None:
        group.command(name, rich_help_panel=panel)(with_options(make)(command))

    return register


def show(document: Any) -> None:
    """Print JSON to standard output, for scripts."""
    print(visible_lines(json.dumps(document, indent=1, ensure_ascii=False)))


def stdout() -> Console:
    # Rich takes a file or a pipe to be 80 columns wide, and would break rows.
    return Console() if sys.stdout.isatty() else Console(width=WIDE)


def show_table(names: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Print a table to standard output; brackets in names are no markup.

    The first column is what people copy: it is never broken.
    """
    heads = [Column(_cell(name), no_wrap=not place) for place, name in enumerate(names)]
    table = Table(*heads, box=None, pad_edge=False)
    for row in rows:
        table.add_row(*map(_cell, row))
    stdout().print(table)


def _cell(value: Any) -> Text:
    if isinstance(value, Text):
        return value
    return Text("" if value is None else visible(str(value)))


def find(client: Client, id: str, deleted: bool = False) -> Run | Sweep:
    """Return the run or the sweep of an id, from the bin if `deleted`.

    Raise `NotFound`, and `Refused` if it is the beginning of one of each.
    """
    both: list[Run | Sweep] = []
    for look in (client.run, client.sweep):
        with suppress(NotFound):
            both.append(look(id, deleted=deleted))
        # A whole id is that of one run: sweeps need not be asked.
        if both and both[0].id == id.strip().lower():
            break
    if not both:
        raise NotFound(f"No run or sweep at {client.url} has an id that begins with {id}.")
    if len(both) > 1:
        run, sweep = both
        raise Refused(f"{id} is the beginning of run {run.id} and of sweep {sweep.id}.")
    return both[0]


def describe(thing: Run | Sweep) -> str:
    """Name a run or a sweep with its status."""
    if isinstance(thing, Sweep):
        return f"{title(thing)}: {counts_as_text(thing.status_counts)}"
    return f"{title(thing)}: {status_of(thing.record)}"


def title(thing: Run | Sweep) -> str:
    """Return the kind, the short id and the name of a run or a sweep."""
    return f"{type(thing).__name__} {thing.id[:8]}{quoted(thing.record)}"
