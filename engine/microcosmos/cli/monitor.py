"""Commands that read runs and sweeps on a server: list, watch, pull, tabulate."""

from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.text import Text
from typer import Argument, Option

from ..client import Client, Run, Sweep
from ..client.formatting import COLOURS, MEASURES, corrected_titles, figure
from .remote import RUNS, Id, Json, find, say, server_command, show, show_table

COLUMNS = ("id", "name", "experiment", "status", "done")


@server_command(RUNS)
def runs(
    client: Client,
    status: Annotated[
        list[str] | None,
        Option(help="queued, running, paused, finished, failed or cancelled; repeatable."),
    ] = None,
    experiment: Annotated[
        list[str] | None, Option(help="Kind of run, such as quality-diversity; repeatable.")
    ] = None,
    tag: Annotated[str | None, Option(help="List only runs with this tag.")] = None,
    search: Annotated[
        str | None, Option("--search", "-s", help="Text in names, tags and notes.")
    ] = None,
    sweep: Annotated[
        str | None, Option(metavar="ID", help="List only runs of this sweep.")
    ] = None,
    deleted: Annotated[bool, Option("--deleted", help="List the runs in the bin.")] = False,
    sort: Annotated[
        str, Option(help="created, name, best, qd_score …; with - in front: descending.")
    ] = "-created",
    limit: Annotated[
        int, Option("--limit", "-n", min=1, help="Largest number of runs to list.")
    ] = 20,
    json: Json = False,
) -> None:
    """List runs, newest first."""
    found = client.runs(
        status=status or (),
        experiment=experiment or (),
        tag=tag,
        text=search,
        sweep=client.sweep(sweep) if sweep else None,
        deleted=deleted,
        sort=sort,
    )
    records = [run.record for run in islice(found, limit + 1)]
    if json:
        show(records[:limit])
        return
    titles = MEASURES | corrected_titles(records[:limit])
    rows = (_row(record, titles) for record in records[:limit])
    show_table((*COLUMNS, *titles.values()), rows)
    if len(records) > limit:
        say(f"More runs exist: --limit {10 * limit} lists them.")


@server_command(RUNS)
def watch(
    client: Client,
    id: Annotated[
        str | None,
        Argument(metavar="ID", help="Id of a run or a sweep; its first characters are enough."),
    ] = None,
    last: Annotated[bool, Option("--last", help="Watch the newest run.")] = False,
) -> None:
    """Watch a run or a sweep until it ends. Ctrl-C stops watching, not the run.

    Exit status: 0 if it finished, 1 if it failed or was cancelled, 130 after Ctrl-C.
    """
    if (id is None) != last:
        raise typer.BadParameter("watch needs an ID or --last, but not both")
    watch_to_end(client.last() if id is None else find(client, id))


@server_command(RUNS)
def pull(
    client: Client,
    id: Id,
    out: Annotated[
        Path | None,
        Option(
            help="File or folder to write to; default: the current folder.", show_default=False
        ),
    ] = None,
) -> None:
    """Download the archive file of a run; repeat the command to resume a download."""
    print(client.run(id).pull(out))


@server_command(RUNS)
def phylogeny(
    client: Client,
    id: Id,
    newick: Annotated[bool, Option("--newick", help="Print Newick instead.")] = False,
) -> None:
    """Print the tree of a run as a table in the ALife phylogeny standard."""
    print(client.run(id).phylogeny("nwk" if newick else "csv"), end="")


@server_command(RUNS)
def sweep(
    client: Client,
    id: Id,
    runs: Annotated[bool, Option("--runs", help="Print a row for each run.")] = False,
    json: Json = False,
) -> None:
    """Print the results of a sweep: median and quartiles of each case."""
    one = client.sweep(id)
    if runs:
        rows = [{**row, "run": row["run"][:8]} for row in one.rows()]
    else:
        rows = [_case(case) for case in one.summary().cases]
    if json:
        show(rows)
        return
    names = list(dict.fromkeys(name for row in rows for name in row))
    show_table(names, ([_cell(row.get(name)) for name in names] for row in rows))


def watch_to_end(thing: Run | Sweep) -> None:
    """Watch until the end; exit with status 0 if all finished, else 1."""
    end = thing.watch()
    statuses = {end} if isinstance(end, str) else {status for status in end if end[status]}
    raise typer.Exit(0 if statuses <= {"finished"} else 1)


def _row(record: dict[str, Any], measures: Iterable[str]) -> list[Any]:
    status = record["status"]
    return [
        record["id"][:8],
        record["name"],
        record["experiment"],
        Text(status, COLOURS.get(status, "default")),
        f"{100 * record['progress']:.0f} %",
        *(figure(name, record[name]) for name in measures),
    ]


def _case(case: dict[str, Any]) -> dict[str, Any]:
    """Return median and quartiles of each measure, at the generation that all runs reached."""
    measures = {}
    known = [{name: one["median"] for name, one in case["finals"].items()}]
    for name in MEASURES | corrected_titles(known):
        final = case["finals"].get(name) or {}
        measures[name] = {part: final.get(part) for part in ("median", "low", "high")}
    return {
        **case["values"],
        "runs": len(case["members"]),
        "finished": sum(one["status"] == "finished" for one in case["members"]),
        **measures,
    }


def _cell(value: Any) -> str:
    if isinstance(value, dict):
        if value.get("median") is None:
            return "–"
        return f"{value['median']:.4g} ({value['low']:.4g} to {value['high']:.4g})"
    if value is None:
        return "–"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
