"""Runs on a server: listed, watched, fetched."""

from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.text import Text

from ..client import Run, Sweep, formatting
from .app import app
from .remote import RUNS, Id, Json, Token, Url, found, reaching, say, show
from .tables import shown

COLOURS = {"finished": "green", "failed": "red", "running": "cyan", "paused": "yellow"}
COLUMNS = ("id", "name", "experiment", "status", "done", "QD score", "coverage", "best")


@app.command(rich_help_panel=RUNS)
def runs(
    status: Annotated[
        list[str] | None, typer.Option(help="queued, running, finished ...; several may stand.")
    ] = None,
    experiment: Annotated[list[str] | None, typer.Option(help="Likewise.")] = None,
    tag: Annotated[str | None, typer.Option(help="Only those with it.")] = None,
    search: Annotated[
        str | None, typer.Option("--search", "-s", help="Text in names, tags and notes.")
    ] = None,
    sweep: Annotated[str | None, typer.Option(metavar="ID", help="Only this sweep's.")] = None,
    deleted: Annotated[bool, typer.Option("--deleted", help="Those in the bin.")] = False,
    sort: Annotated[
        str, typer.Option(help="created, name, best, qd_score ...; with - descending.")
    ] = "-created",
    most: Annotated[int, typer.Option("--most", "-n", min=1, help="At most so many.")] = 20,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """List runs, the newest first."""
    with reaching(url, token) as client:
        like = client.runs(
            status=status or (),
            experiment=experiment or (),
            tag=tag,
            text=search,
            sweep=client.sweep(sweep) if sweep else None,
            deleted=deleted,
            sort=sort,
        )
        records = [run.record for run in islice(like, most + 1)]
    if json:
        show(records[:most])
        return
    shown(COLUMNS, map(_row, records[:most]))
    if len(records) > most:
        say(f"There are more: --most {10 * most} lists up to so many.")


@app.command(rich_help_panel=RUNS)
def watch(
    id: Annotated[
        str | None, typer.Argument(metavar="ID", help="Of a run or a sweep, or its beginning.")
    ] = None,
    last: Annotated[bool, typer.Option("--last", help="The newest run.")] = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Watch a run or a sweep until it ends. Ctrl-C leaves it going.

    Ends with 0 where it finished, 1 where it failed or was cancelled, 130 after Ctrl-C.
    """
    if (id is None) != last:
        raise typer.BadParameter("watch needs an ID or --last, and not both")
    with reaching(url, token) as client:
        raise typer.Exit(ended(client.last() if id is None else found(client, id)))


@app.command(rich_help_panel=RUNS)
def pull(
    id: Id,
    out: Annotated[
        Path | None, typer.Option(help="A file or a folder; default: here.", show_default=False)
    ] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Fetch a run's archive file; broken off, the same command goes on."""
    with reaching(url, token) as client:
        print(client.run(id).pull(out))


def ended(watched: "Run | Sweep") -> int:
    """Watch it to its end; how the command ends then."""
    end = watched.watch()
    good = {"finished"} >= ({end} if isinstance(end, str) else {s for s in end if end[s]})
    return 0 if good else 1


def _row(record: dict[str, Any]) -> list[Any]:
    status = record["status"]
    figures = [
        formatting.figure(name, record[name]) for name in ("qd_score", "coverage", "best")
    ]
    coloured = Text(status, COLOURS.get(status, "default"))
    done = f"{100 * record['progress']:.0f} %"
    names = [record["id"][:8], record["name"], record["experiment"]]
    return [*names, coloured, done, *figures]
