"""Commands that change runs and sweeps on a server: pause, extend, fork, delete."""

from collections.abc import Callable
from typing import Annotated, Any

import typer

from . import overrides
from .app import app
from .monitor import ended
from .remote import RUNS, Id, Ids, Json, Token, Url, about, found, reaching, say, show, title
from .submit import Name, Set, Watch, tell
from .sweeps import cases, members, table

Yes = Annotated[bool, typer.Option("--yes", "-y", help="Do not ask for confirmation.")]


@app.command(rich_help_panel=RUNS)
def extend(
    id: Id,
    generations: Annotated[int, typer.Argument(min=1, help="Number of generations to add.")],
    watch: Watch = False,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Add generations to a run."""
    with reaching(url, token) as client:
        run = client.run(id).extend(generations)
        tell(run, json)
        if watch:
            raise typer.Exit(ended(run))


@app.command(rich_help_panel=RUNS)
def fork(
    id: Id,
    elite: Annotated[
        list[str] | None,
        typer.Option(metavar="SHA", help="Start from this creature; repeatable."),
    ] = None,
    cells: Annotated[
        str | None,
        typer.Option(metavar="N,N,...", help="Start from the elites of these cells."),
    ] = None,
    region: Annotated[
        list[str] | None,
        typer.Option(
            metavar="AXIS=LOW:HIGH",
            help="Start from the elites with measures in this range; repeatable.",
        ),
    ] = None,
    whole: Annotated[
        bool, typer.Option("--all", help="Start from all elites (default).")
    ] = False,
    generation: Annotated[
        int | None, typer.Option(min=0, help="Take the archive after this generation.")
    ] = None,
    settings: Set = None,
    name: Name = None,
    watch: Watch = False,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Start a new run from elites of another run."""
    chosen: dict[str, Any] = {
        "creatures": elite or None,
        "cells": _numbers(cells),
        "region": overrides.region(region) if region else None,
    }
    named = [how for how, what in chosen.items() if what is not None]
    if len(named) + whole > 1:
        raise typer.BadParameter("fork takes one of --elite, --cells, --region and --all")
    patch = overrides.patch(settings or [])
    with reaching(url, token) as client:
        run = client.run(id).fork(**chosen, generation=generation, spec=patch, name=name)
        tell(run, json)
        if watch:
            raise typer.Exit(ended(run))


@app.command(rich_help_panel=RUNS)
def pause(ids: Ids, url: Url = None, token: Token = None) -> None:
    """Pause runs or sweeps; `resume` continues them."""
    _each(ids, url, token, lambda one: one.pause())


@app.command(rich_help_panel=RUNS)
def resume(ids: Ids, url: Url = None, token: Token = None) -> None:
    """Resume paused runs or sweeps."""
    _each(ids, url, token, lambda one: one.resume())


@app.command(rich_help_panel=RUNS)
def cancel(ids: Ids, url: Url = None, token: Token = None) -> None:
    """Cancel runs or sweeps for good; results so far are kept."""
    _each(ids, url, token, lambda one: one.cancel())


@app.command(rich_help_panel=RUNS)
def delete(ids: Ids, yes: Yes = False, url: Url = None, token: Token = None) -> None:
    """Move runs or sweeps to the bin; `restore` brings them back within a day."""
    with reaching(url, token) as client:
        for one in [found(client, id) for id in ids]:
            if not yes and not typer.confirm(f"{about(one)}. Delete?", err=True):
                say(f"{title(one)} is not deleted.")
                continue
            record = one.delete().record
            if record.get("total"):  # Of a sweep.
                say(f"{about(one)}; the other runs have not ended: cancel them first")
            if record.get("deleted", True):
                undo = f"microcosmos restore {one.id[:8]}"
                say(f"{title(one)} is in the bin. To restore it: {undo}")


@app.command(rich_help_panel=RUNS)
def restore(ids: Ids, url: Url = None, token: Token = None) -> None:
    """Restore runs or sweeps from the bin."""
    with reaching(url, token) as client:
        for one in [found(client, id, deleted=True) for id in ids]:
            say(f"{title(one.restore())} is restored.")


@app.command(rich_help_panel=RUNS)
def sweep(
    id: Id,
    runs: Annotated[bool, typer.Option("--runs", help="Print a row for each run.")] = False,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Print the results of a sweep: median and quartiles of each case."""
    with reaching(url, token) as client:
        one = client.sweep(id)
        rows = members(one) if runs else cases(one)
    if json:
        show(rows)
    else:
        table(rows)


def _each(ids: list[str], url: str | None, token: str | None, do: Callable[[Any], Any]) -> None:
    with reaching(url, token) as client:
        for one in [found(client, id) for id in ids]:
            say(about(do(one)))


def _numbers(text: str | None) -> list[int] | None:
    if text is None:
        return None
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"--cells needs numbers such as 3,17; got {text!r}") from None
