"""The command `study`: carry out a study from one file, and write its report."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer import Argument, Option

from ..archive.file_names import beside
from ..client.formatting import duration
from .app import CACHE, Modules, app, failing, load_modules, progress_bar, say, stopping
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
        float,
        Option(min=0.0, help="Seconds between two checkpoints of a run; 0: each generation."),
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
        from ..study import decode, plan, report
        from ..study.runs import alone

        source = file.read_bytes()  # Once: the file may change while the runs are carried out.
        study = decode(source, file.name)
        planned = plan(study, folder or beside(file, ".study"), file.parent)
        if dry_run:
            _show(planned, processes)
            return
        # Two processes would write the same checkpoints
        # (test_a_folder_has_one_study_at_a_time).
        with alone(planned.folder, "" if folder else file.name):
            if server:
                _on_server(planned, url, token)
            else:
                _carry_out(planned, processes, module or [], checkpoint_seconds)
            # Names alone: a report has no folders of a machine.
            modules = [f"--module={one.name}" for one in module or ()]
            command = shlex.join(["microcosmos", "study", file.name, *modules])
            paths = report.write(planned, source, command)
    for path in paths[:1]:
        print(path)
    if others := len(paths) - 1:
        files = "1 file" if others == 1 else f"{others} files"
        say(f"Beside the report: {files} of figures and exports.")


def _show(plan: "Plan", processes: int) -> None:
    """Print every run with how far it is, and the estimated time of what is left."""
    from ..spec import estimate
    from ..spec.paths import value_text
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
    say(f"{len(rows)} runs; about {left:,} evaluations are left: {time}")


def _carry_out(
    plan: "Plan", processes: int, modules: list[Path], checkpoint_seconds: float
) -> None:
    from ..device import prepare
    from ..study import local

    prepare(cache=CACHE)
    with stopping() as stopped, progress_bar() as progress:
        bar = progress.add_task("", total=None)

        def tell(progress_so_far: local.Progress) -> None:
            left = progress_so_far.seconds_left
            description = f"{progress_so_far.finished} of {progress_so_far.runs} runs"
            description += "" if left is None else f", {duration(left)} left"
            progress.update(
                bar,
                completed=progress_so_far.done,
                total=progress_so_far.work,
                description=description,
            )

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
        say(f"Stopped. The same command goes on from {plan.folder}.")
        raise typer.Exit(130)


def _on_server(plan: "Plan", url: str | None, token: str | None) -> None:
    from ..client import Client
    from ..client.formatting import counts_as_text
    from ..study import remote

    with Client(url, token) as client, progress_bar() as progress:
        bar = progress.add_task("", total=len(plan.runs))

        def tell(counts: dict[str, int]) -> None:
            done = counts.get("finished", 0)
            progress.update(bar, completed=done, description=counts_as_text(counts))

        remote.carry_out(plan, client, tell)
