"""Commands that create and change runs and sweeps on a server."""

from typing import Annotated, Any

import typer
from typer import Argument, Option

from ..client import Client, Run, Sweep
from ..client import specs as server_specs
from . import specs
from .app import Set
from .monitor import watch_to_end
from .remote import RUNS, Id, Ids, Json, describe, find, say, server_command, show, title

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
    spec: Annotated[str, Argument(help="Spec file, or name of a preset.")],
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
    asked = {"priority": priority, "labels": label, "may_yield": may_yield or None}
    asked |= {"device_patience": device_patience}
    scheduling = {field: value for field, value in asked.items() if value is not None}
    grid = specs.grid(sweep or [])
    document = specs.applied(server_specs.document(client.connection, spec), settings or [])
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
    """Cancel runs or sweeps for good; results so far are kept."""
    _each(client, ids, "cancel")


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
