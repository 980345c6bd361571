"""Commands that read runs on a server: list, watch, pull."""

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
        list[str] | None,
        typer.Option(
            help="queued, running, paused, finished, failed or cancelled; repeatable."
        ),
    ] = None,
    experiment: Annotated[
        list[str] | None,
        typer.Option(help="Kind of run, such as quality-diversity; repeatable."),
    ] = None,
    tag: Annotated[str | None, typer.Option(help="List only runs with this tag.")] = None,
    search: Annotated[
        str | None, typer.Option("--search", "-s", help="Text in names, tags and notes.")
    ] = None,
    sweep: Annotated[
        str | None, typer.Option(metavar="ID", help="List only runs of this sweep.")
    ] = None,
    deleted: Annotated[
        bool, typer.Option("--deleted", help="List the runs in the bin.")
    ] = False,
    sort: Annotated[
        str, typer.Option(help="created, name, best, qd_score …; with - in front: descending.")
    ] = "-created",
    limit: Annotated[
        int, typer.Option("--limit", "-n", min=1, help="Number of runs to list at limit.")
    ] = 20,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """List runs, newest first."""
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
        records = [run.record for run in islice(like, limit + 1)]
    if json:
        show(records[:limit])
        return
    shown(COLUMNS, map(_row, records[:limit]))
    if len(records) > limit:
        say(f"More runs exist: --limit {10 * limit} lists them.")


@app.command(rich_help_panel=RUNS)
def watch(
    id: Annotated[
        str | None,
        typer.Argument(
            metavar="ID", help="Id of a run or a sweep; its first characters are enough."
        ),
    ] = None,
    last: Annotated[bool, typer.Option("--last", help="Watch the newest run.")] = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Watch a run or a sweep until it ends. Ctrl-C stops watching, not the run.

    Exit status: 0 if it finished, 1 if it failed or was cancelled, 130 after Ctrl-C.
    """
    if (id is None) != last:
        raise typer.BadParameter("watch needs an ID or --last, but not both")
    with reaching(url, token) as client:
        raise typer.Exit(ended(client.last() if id is None else found(client, id)))


@app.command(rich_help_panel=RUNS)
def pull(
    id: Id,
    out: Annotated[
        Path | None,
        typer.Option(
            help="File or folder to write to; default: the current folder.", show_default=False
        ),
    ] = None,
    url: Url = None,
    token: Token = None,
) -> None:
    """Download the archive file of a run; repeat the command to resume a download."""
    with reaching(url, token) as client:
        print(client.run(id).pull(out))


def ended(watched: "Run | Sweep") -> int:
    """Watch until the end; return the exit status."""
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
