"""The command `study`: carry out a study from one file, and write its report."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn
from typer import Argument, Option

from ..archive.beside import beside
from ..client.formatting import duration
from .app import CACHE, app, console, failing
from .modules import Modules, load_modules
from .remote import Token, Url, show_table

if TYPE_CHECKING:
    from ..study import Plan


@app.command()
def study(
    file: Annotated[
        Path, Argument(exists=True, dir_okay=False, help="The study, as YAML or JSON.")
    ],
    folder: Annotated[
        Path | None,
        Option("--out", help="Folder of runs, figures and report; default: NAME.study."),
    ] = None,
    processes: Annotated[
        int, Option("--processes", "-p", min=1, help="Number of runs at a time.")
    ] = 1,
    dry_run: Annotated[
        bool, Option("--dry-run", help="Print the runs and what is left, and stop.")
    ] = False,
    checkpoint_seconds: Annotated[
        float, Option(min=0.0, help="Seconds between two checkpoints of a run.")
    ] = 20.0,
    server: Annotated[
        bool, Option("--server", help="Carry out the runs on the server, and download them.")
    ] = False,
    url: Url = None,
    token: Token = None,
    module: Modules = None,
) -> None:
    """Carry out a study: sweeps, comparisons, figures, exports, and a report in HTML.

    Repeat the command to go on after an interruption: finished runs are not repeated.
    """
    load_modules(module)
    with failing(file):
        from ..study import plan, read, report
        from ..study.lock import alone

        found = plan(read(file), folder or beside(file, ".study"), file.parent)
        if dry_run:
            _show(found, processes)
            return
        with alone(found.folder):
            if server:
                _on_server(found, url, token)
            else:
                _carry_out(found, processes, module or [], checkpoint_seconds)
            command = f"microcosmos study {file.name}"
            paths = report.write(found, file.read_text(), command)
    for path in paths[:1]:
        print(path)
    console.print(f"{len(paths) - 1} files of figures and exports are beside the report.")


def _show(plan: "Plan", processes: int) -> None:
    """Print every run with how far it is, and the estimated time of what is left."""
    from ..spec import estimate
    from ..spec.differences import value_text
    from ..study.local import estimated_seconds

    rows, left = [], 0
    for run in plan.unique():
        generation, finished = run.done()
        wanted = run.spec.generations
        share = 1.0 if finished else generation / wanted
        left += round((1 - share) * estimate(run.spec).evaluations)
        state = "finished" if finished else f"{generation:,} of {wanted:,} generations"
        case = ", ".join(f"{path} {value_text(value)}" for path, value in run.values.items())
        rows.append((run.id, run.sweep, case or "–", run.spec.seed, state))
    show_table(("run", "sweep", "case", "seed", "state"), rows)
    seconds = estimated_seconds(plan, processes)
    time = "time unknown until a run is finished" if seconds is None else duration(seconds)
    console.print(f"{len(rows)} runs; about {left:,} evaluations are left: {time}")


def _carry_out(
    plan: "Plan", processes: int, modules: list[Path], checkpoint_seconds: float
) -> None:
    from ..device import prepare
    from ..study import local

    prepare(cache=CACHE)
    with _stopping() as stopped, _bar() as progress:
        bar = progress.add_task("", total=None)

        def tell(found: local.Progress) -> None:
            left = found.seconds_left
            said = f"{found.finished} of {found.runs} runs"
            said += "" if left is None else f", {duration(left)} left"
            progress.update(bar, completed=found.done, total=found.work, description=said)

        done = local.carry_out(
            plan,
            processes=processes,
            tell=tell,
            stop=lambda: bool(stopped),
            modules=modules,
            checkpoint_seconds=checkpoint_seconds,
            cache=CACHE,
        )
    if not done:
        console.print(f"Stopped. The same command goes on from {plan.folder}.")
        raise typer.Exit(130)


def _on_server(plan: "Plan", url: str | None, token: str | None) -> None:
    from ..client import Client
    from ..client.formatting import counts_as_text
    from ..study import remote

    with Client(url, token) as client, _bar() as progress:
        bar = progress.add_task("", total=len(plan.runs))

        def tell(counts: dict[str, int]) -> None:
            done = counts.get("finished", 0)
            progress.update(bar, completed=done, description=counts_as_text(counts))

        remote.carry_out(plan, client, tell)


def _bar() -> Progress:
    return Progress(
        SpinnerColumn(), BarColumn(), TextColumn("{task.description}"), console=console
    )


@contextmanager
def _stopping() -> Iterator[list[int]]:
    """Yield a list that holds the signals that came; the second one ends the process."""
    received: list[int] = []

    def note(number: int, frame: Any) -> None:
        received.append(number)
        signal.signal(number, signal.SIG_DFL)

    before = {one: signal.signal(one, note) for one in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield received
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
