"""The command `evolve`: carry out a run without a server."""

import os
import signal
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeRemainingColumn,
)

from ..spec import Spec, estimate
from .app import CACHE, app, console, fail
from .fork import From, begun, refuse_without_files
from .modules import Modules, load_modules
from .specs import changed, lasting, presets, read_spec
from .submit import Set


@app.command()
def evolve(
    spec: Annotated[str, typer.Argument(help="Spec file, or name of a preset.")],
    archive: Annotated[
        Path | None, typer.Option("--out", help="Archive file; default: beside the spec.")
    ] = None,
    generations: Annotated[
        int | None,
        typer.Option(
            help="Total number of generations; extends a finished archive. Default: the spec's."
        ),
    ] = None,
    settings: Set = None,
    checkpoint_seconds: Annotated[float, typer.Option(min=0.0)] = 60.0,
    other_device: Annotated[
        bool, typer.Option(help="Continue a run that another kind of device started.")
    ] = False,
    begin_from: From = None,
    module: Modules = None,
) -> None:
    """Carry out a run. If the archive file exists, continue it."""
    load_modules(module)
    chosen = changed(read_spec(spec), settings or [])
    if generations is not None:
        chosen = lasting(chosen, generations)
    path = archive or Path(spec.replace("/", "-") if spec in presets() else spec).with_suffix(
        ".h5"
    )
    from ..device import device_kind, prepare

    evaluations = evaluations_of(chosen, path)
    prepare(cache=CACHE)
    chosen, initial = begun(chosen, begin_from or ())
    refuse_without_files(chosen, initial, path)
    console.print(f"{evaluations:,} evaluations on {device_kind()} into {path}")
    if not carry_on(chosen, path, checkpoint_seconds, other_device, initial):
        console.print(f"Stopped. The same command goes on from {path}.")
        raise typer.Exit(130)
    best = path.with_suffix(".best.json")
    console.print(f"Done: {path}" + (f"; the best creature: {best}" if best.exists() else ""))


def evaluations_of(spec: Spec, path: Path) -> int:
    """Make the folder of the file and return the number of evaluations.

    Fails where the folder cannot be made or the memory does not suffice.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        fail(f"--out needs a folder that can be made: {error}")
    need = estimate(spec)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if need.memory_bytes > memory:
        fail(f"the run needs about {need.memory_bytes:,} bytes of memory; {memory:,} are free")
    return need.evaluations


def carry_on(
    spec: Spec,
    archive: Path,
    checkpoint_seconds: float,
    other_device: bool,
    initial: Sequence[Mapping[str, Any]] = (),
) -> bool:
    """Carry out the run with a progress bar; the first Ctrl-C asks it to stop."""
    from .. import experiments
    from ..build import local

    wishes: list[int] = []

    def note(received: int, frame: object) -> None:
        wishes.append(received)
        signal.signal(received, signal.SIG_DFL)  # The second one ends it at once.

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, note)
    columns = [
        SpinnerColumn(),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.description}"),
    ]
    with Progress(*columns, console=console) as progress:
        bar = progress.add_task("compiling", total=spec.generations)

        def tell(report) -> None:
            progress.update(bar, completed=report.generation, description=_told(report))

        try:
            return local.evolve(
                spec,
                archive,
                stop=lambda: bool(wishes),
                tell=tell,
                checkpoint_seconds=checkpoint_seconds,
                other_device=other_device,
                initial=initial,
            )
        except experiments.OtherDevice as error:
            progress.stop()
            fail(f"{archive}: {error} To continue here anyway, add --other-device.")
        except (ValueError, OSError) as error:
            progress.stop()
            fail(f"{archive}: {error}")


def _told(report: Any) -> str:
    """Summarise a generation in a few words."""
    if report.qd_score is None:
        return "  ".join(f"{name} {value}" for name, value in _short(report.summary).items())
    return (
        f"QD score {report.qd_score:.2f}  coverage {100 * report.coverage:.1f} %  "
        f"best {report.best:.2f}"
    )


def _short(summary: Mapping[str, Any] | None) -> dict[str, str]:
    values = (summary or {}).items()
    return {
        name.replace("_", " "): f"{value:.4g}" if isinstance(value, float) else f"{value}"
        for name, value in values
        if value is not None
    }
