"""Commands that list, watch, create and change runs and sweeps on a server."""

from collections.abc import Iterable, Sequence
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.text import Text
from typer import Argument, Option

from ..archive.curves import CORRECTED
from ..client import Client, Run, Sweep
from ..client import specs as server_specs
from ..client.formatting import COLOURS, MEASURES, corrected_titles, figure, visible
from ..spec.paths import value_texts
from . import specs
from .app import Set, say
from .remote import (
    RUNS,
    Id,
    Ids,
    Json,
    describe,
    find,
    server_command,
    show,
    show_table,
    title,
)

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
    listed = client.runs(
        status=status or (),
        experiment=experiment or (),
        tag=tag,
        text=search,
        sweep=sweep,
        deleted=deleted,
        sort=sort,
    )
    # One more than the limit tells whether there are more, without a count of all.
    records = [run.record for run in islice(listed, limit + 1)]
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
    rows = one.rows() if runs else [_case(case) for case in one.summary().cases]
    if json:
        show(rows)
        return
    names = list(dict.fromkeys(name for row in rows for name in row))
    if runs:
        rows = [{**row, "run": row["run"][:8]} for row in rows]
    columns = [_column(name, [row.get(name) for row in rows]) for name in names]
    show_table(names, zip(*columns, strict=True))


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
        Text(visible(status), COLOURS.get(status, "default")),
        f"{100 * record['progress']:.0f} %",
        *(figure(name, record[name]) for name in measures),
    ]


def _case(case: dict[str, Any]) -> dict[str, Any]:
    """Return a row of a case: the quartiles of each measure where all runs have arrived."""
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


def _column(name: str, values: Sequence[Any]) -> list[str]:
    measured = name in MEASURES or name in CORRECTED
    # Values of cases are not rounded: two might look the same.
    return list(map(_figure, values)) if measured else value_texts(values)


def _figure(value: Any) -> str:
    if isinstance(value, dict):
        if value["median"] is None:
            return "–"
        return f"{value['median']:.4g} ({value['low']:.4g} to {value['high']:.4g})"
    return "–" if value is None else f"{value:.4g}"


Name = Annotated[str | None, Option(help="Name of the run.")]
Priority = Annotated[
    str | None,
    Option(help="low, normal or high among your runs; urgent before all (admins)."),
]
Patience = Annotated[
    float | None,
    Option(
        metavar="SECONDS", help="Wait so long for the same kind of device, then take another."
    ),
]
Watch = Annotated[bool, Option("--watch", "-w", help="Watch until it ends.")]
Yes = Annotated[bool, Option("--yes", "-y", help="Do not ask for confirmation.")]


@server_command(RUNS)
def submit(
    client: Client,
    spec: Annotated[
        str, Argument(help="Spec file, - for standard input, or name of a preset.")
    ],
    seeds: Annotated[
        int | None, Option(min=1, help="Queue a sweep with this number of seeds.")
    ] = None,
    settings: Set = None,
    sweep: Annotated[
        list[str] | None,
        Option(
            metavar="FIELD=A,B,...",
            help="Queue a run for each value of a field, which is given once; "
            "several fields make a grid.",
        ),
    ] = None,
    name: Name = None,
    priority: Priority = None,
    label: Annotated[
        list[str] | None, Option(help="A label that the worker must have; repeatable.")
    ] = None,
    may_yield: Annotated[
        bool, Option("--may-yield", help="Return to the queue for an urgent run.")
    ] = False,
    device_patience: Patience = None,
    watch: Watch = False,
    json: Json = False,
) -> None:
    """Queue a run or a sweep, and print its id."""
    options = {"priority": priority, "labels": label, "may_yield": may_yield or None}
    options |= {"device_patience": device_patience}
    # Only given options are sent, so that defaults stand on the server alone.
    scheduling = {field: value for field, value in options.items() if value is not None}
    grid = specs.grid(sweep or [])
    read = (
        specs.standard_input()
        if spec == specs.INPUT
        else server_specs.document(client.connection, spec)
    )
    document = specs.applied(read, settings or [])
    made = client.submit(document, seeds=seeds, grid=grid or None, name=name, **scheduling)
    _report(made, watch, json)


@server_command(RUNS)
def extend(
    client: Client,
    id: Id,
    generations: Annotated[int, Argument(min=1, help="Number of generations to add.")],
    watch: Watch = False,
    json: Json = False,
) -> None:
    """Add generations to a run."""
    _report(client.run(id).extend(generations), watch, json)


@server_command(RUNS)
def fork(
    client: Client,
    id: Id,
    elite: Annotated[
        list[str] | None, Option(metavar="SHA", help="Start from this creature; repeatable.")
    ] = None,
    cells: Annotated[
        str | None, Option(metavar="N,N,...", help="Start from the elites of these cells.")
    ] = None,
    region: Annotated[
        list[str] | None,
        Option(
            metavar="AXIS=LOW:HIGH",
            help="Start from the elites with measures in this range; repeatable, once an axis.",
        ),
    ] = None,
    whole: Annotated[bool, Option("--all", help="Start from all elites (default).")] = False,
    generation: Annotated[
        int | None, Option(min=0, help="Take the archive after this generation.")
    ] = None,
    settings: Set = None,
    name: Name = None,
    watch: Watch = False,
    json: Json = False,
) -> None:
    """Start a new run from elites of another run."""
    chosen: dict[str, Any] = {
        "creatures": elite or None,
        "cells": _numbers(cells),
        "region": specs.region(region) if region else None,
    }
    if whole + sum(what is not None for what in chosen.values()) > 1:
        raise typer.BadParameter("fork takes one of --elite, --cells, --region and --all")
    patch = specs.patch(settings or [])
    run = client.run(id).fork(**chosen, generation=generation, spec=patch, name=name)
    _report(run, watch, json)


@server_command(RUNS)
def choose(
    client: Client,
    id: Id,
    creatures: Annotated[
        list[str], Argument(metavar="SHA...", help="Creatures of the run's archive.")
    ],
) -> None:
    """Let a part of the next generations descend from creatures of a run."""
    client.run(id).choose(creatures)


@server_command(RUNS)
def choices(client: Client, id: Id) -> None:
    """Print the chosen creatures of a run, as `evolve --choices` reads them."""
    show(client.run(id).exported_choices())


@server_command(RUNS)
def pause(client: Client, ids: Ids) -> None:
    """Pause runs or sweeps; `resume` continues them."""
    _each(client, ids, "pause")


@server_command(RUNS)
def resume(client: Client, ids: Ids) -> None:
    """Resume paused runs or sweeps."""
    _each(client, ids, "resume")


@server_command(RUNS)
def cancel(client: Client, ids: Ids) -> None:
    """Cancel runs or sweeps; results so far are kept, and `uncancel` takes it back."""
    _each(client, ids, "cancel")


@server_command(RUNS)
def uncancel(client: Client, ids: Ids) -> None:
    """Take the cancellation of runs or sweeps back; they go on from their checkpoints."""
    _each(client, ids, "uncancel")


@server_command(RUNS)
def delete(client: Client, ids: Ids, yes: Yes = False) -> None:
    """Move runs or sweeps to the bin; `restore` brings them back within a day.

    Exit status 1 if all runs of a sweep are queued or running, so that none is deleted.
    """
    refused = False
    for one in [find(client, id) for id in ids]:
        if not yes and not typer.confirm(f"{describe(one)}. Delete?", err=True):
            say(f"{title(one)} is not deleted.")
            continue
        # The server keeps queued and running runs of a sweep: nothing deleted is an error
        # (test_a_sweep_of_which_nothing_can_be_deleted_is_an_error).
        before = one.record.get("total")
        left = one.delete().record.get("total")
        if left:
            say(f"{describe(one)}; queued and running runs are kept: cancel them first")
        if left and left == before:
            refused = True
            continue
        gone = f"The ended part of {title(one)}" if left else title(one)
        say(f"{gone} is in the bin. To restore it: microcosmos restore {one.id[:8]}")
    if refused:
        raise typer.Exit(1)


@server_command(RUNS)
def restore(client: Client, ids: Ids) -> None:
    """Restore runs or sweeps from the bin."""
    for one in [find(client, id, deleted=True) for id in ids]:
        say(f"{title(one.restore())} is restored.")


def _each(client: Client, ids: list[str], action: str) -> None:
    for one in [find(client, id) for id in ids]:
        say(describe(getattr(one, action)()))


def _report(made: Run | Sweep, watch: bool, json: bool) -> None:
    if json:
        show(made.record)
    else:
        # Alone on standard output and at once: scripts read it while `--watch` goes on.
        print(made.id, flush=True)
        what = f"A sweep of {made.total} runs" if isinstance(made, Sweep) else made.status
        say(f"{what}; to watch it: microcosmos watch {made.id[:8]}")
    if watch:
        watch_to_end(made)


def _numbers(text: str | None) -> list[int] | None:
    if text is None:
        return None
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"--cells needs numbers such as 3,17; got {text!r}") from None
