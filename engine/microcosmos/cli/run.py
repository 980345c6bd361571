"""Commands that carry out runs without a server: evolve, refine."""

import json
import signal
from collections.abc import Mapping, Sequence
from functools import partial
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
from typer import Argument, Option

from ..archive import choices as choices_file
from ..archive.beside import beside
from ..archive.creature_h5 import read
from ..archive.file import read_table
from ..doctor.machine import memory_bytes
from ..sinks.address import parse_all
from ..spec import Archive, Refinement, Spec, estimate
from .app import CACHE, CreaturePath, OtherDevice, Set, app, console, fail, failing
from .cluster import Certificate
from .initial import From, with_initial
from .modules import Modules, load_modules
from .specs import changed, read_spec, spec_path, with_generations

Choices = Annotated[
    Path | None,
    Option(
        exists=True,
        dir_okay=False,
        help="File of chosen creatures that generations descend from, as a server exports it.",
    ),
]

SinkAddresses = Annotated[
    list[str] | None,
    Option(
        "--sink",
        help="Also send curves, pictures and files to tensorboard:FOLDER, mlflow:URI or "
        "wandb:PROJECT; repeatable.",
    ),
]


@app.command()
def evolve(
    spec: Annotated[
        str, Argument(help="Spec file, name of a preset, or address of a shared archive.")
    ],
    archive: Annotated[
        Path | None, Option("--out", help="Archive file; default: beside the spec.")
    ] = None,
    generations: Annotated[
        int | None,
        Option(
            help="Total number of generations; extends a finished archive. Default: the spec's."
        ),
    ] = None,
    settings: Set = None,
    checkpoint_seconds: Annotated[
        float, Option(min=0.0, help="Seconds between two checkpoints.")
    ] = 60.0,
    other_device: OtherDevice = False,
    begin_from: From = None,
    choices: Choices = None,
    cluster: Annotated[
        str | None,
        Option(help="Scheduler whose helpers compute too, like tls://host:8786."),
    ] = None,
    certificate: Certificate = None,
    sink: SinkAddresses = None,
    module: Modules = None,
) -> None:
    """Carry out a run. If the archive file exists, continue it."""
    load_modules(module)
    with failing("--sink"):
        parse_all(sink or ())
    chosen = changed(read_spec(spec), settings or [])
    if generations is not None:
        chosen = with_generations(chosen, generations)
    path = archive or beside(spec_path(spec), ".h5")
    evaluations = prepare_run(chosen, path)
    from ..device import device_kind

    chosen, initial = with_initial(chosen, begin_from or (), path)
    console.print(f"{evaluations:,} evaluations on {device_kind()} into {path}")
    options = {**_over(cluster, certificate), "choices": _read_choices(choices)}
    options["sinks"] = sink or ()
    run_with_progress(chosen, path, checkpoint_seconds, other_device, initial, **options)
    best = beside(path, ".best.json")
    console.print(f"Done: {path}" + (f"; the best creature: {best}" if best.exists() else ""))


@app.command()
def refine(
    file: CreaturePath,
    like: Annotated[
        str | None,
        Option(
            help="Spec or preset whose archive cells bound the search; default: 20 × 20 cells."
        ),
    ] = None,
    steps: Annotated[int, Option(min=1, help="Number of steps.")] = 20,
    length: Annotated[float, Option(help="Length of the first step.")] = 0.2,
    out: Annotated[Path | None, Option(help="Archive file; default: NAME.refined.h5.")] = None,
    segment: Annotated[
        int | None,
        Option(
            min=1,
            help="Simulation steps whose states the gradient keeps in memory; default: all.",
        ),
    ] = None,
    other_device: OtherDevice = False,
    module: Modules = None,
) -> None:
    """Improve a creature by gradient steps that stay in its cell."""
    load_modules(module)
    path = out or beside(file, ".refined.h5")
    with failing(file):
        spec = Refinement(
            creature=read(file.read_bytes()),
            archive=_archive(like),
            steps=steps,
            length=length,
            segment=segment,
        )
    prepare_run(spec, path)
    run_with_progress(spec, path, 60.0, other_device)
    _print_comparison(path)


def prepare_run(spec: Spec, path: Path) -> int:
    """Make the file's folder and start JAX; return the number of evaluations.

    Fail if the folder cannot be made or the memory does not suffice.
    """
    with failing("--out needs a folder that can be made"):
        path.parent.mkdir(parents=True, exist_ok=True)
    need, (memory, _) = estimate(spec), memory_bytes()
    if need.memory_bytes > memory:
        fail(f"the run needs about {need.memory_bytes:,} bytes of memory; there are {memory:,}")
    from ..device import prepare

    prepare(cache=CACHE)
    return need.evaluations


def run_with_progress(
    spec: Spec,
    archive: Path,
    checkpoint_seconds: float,
    other_device: bool,
    initial: Sequence[Mapping[str, Any]] = (),
    **options: Any,
) -> None:
    """Carry out the run with a progress bar; exit with status 130 if a signal stops it."""
    from .. import experiments
    from ..build import local

    received: list[int] = []

    def note(number: int, frame: object) -> None:
        received.append(number)
        signal.signal(number, signal.SIG_DFL)  # The second signal ends it at once.

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, note)
    columns = [
        SpinnerColumn(),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.description}"),
    ]
    with failing(archive), Progress(*columns, console=console) as progress:
        bar = progress.add_task("compiling", total=spec.generations)

        def tell(report: Any) -> None:
            progress.update(bar, completed=report.generation, description=_summary(report))

        try:
            done = local.evolve(
                spec,
                archive,
                stop=lambda: bool(received),
                tell=tell,
                checkpoint_seconds=checkpoint_seconds,
                other_device=other_device,
                initial=initial,
                **options,
            )
        except experiments.OtherDevice as error:
            raise ValueError(f"{error} To continue here anyway, add --other-device.") from error
    if not done:
        console.print(f"Stopped. The same command goes on from {archive}.")
        raise typer.Exit(130)


def _read_choices(path: Path | None) -> dict[int, choices_file.Files] | None:
    if path is None:
        return None
    with failing(f"--choices: {path}"):
        return choices_file.parse(path.read_bytes())


def _over(cluster: str | None, certificate: Path | None) -> dict[str, Any]:
    """Return the option that puts a run on a cluster, if one is named."""
    if cluster is None:
        return {}
    from ..cluster import over

    return {"over": partial(over, url=cluster, certificate=certificate)}


def _summary(report: Any) -> str:
    if report.qd_score is None:
        values = (report.summary or {}).items()
        shown = ((name, value) for name, value in values if value is not None)
        return "  ".join(
            f"{name.replace('_', ' ')} {f'{value:.4g}' if isinstance(value, float) else value}"
            for name, value in shown
        )
    text = (
        f"QD score {report.qd_score:.2f}  coverage {100 * report.coverage:.1f} %  "
        f"best {report.best:.2f}"
    )
    found = report.summary or {}
    if "cluster: efficiency" in found:
        busy = 100 * found["cluster: efficiency"]
        text = f"{text}  {found['cluster: devices']} devices, {busy:.0f} % busy"
    if "corrected_qd_score" not in found:
        return text
    return (
        f"{text}  corrected: QD score {found['corrected_qd_score']:.2f}  coverage "
        f"{100 * found['corrected_coverage']:.1f} %  hit rate {100 * found['hit_rate']:.1f} %"
    )


def _archive(like: str | None) -> Archive:
    if like is None:
        return Archive()
    found = getattr(read_spec(like), "archive", None)
    if found is None:
        fail(f"--like needs a spec with an archive, got {like}")
    return found


def _print_comparison(path: Path) -> None:
    rows = read_table(path.read_bytes()).rows
    before, after = rows[0], rows[-1]
    print(f"{'':>20}  {'before':>12}  {'after':>12}")
    for name in before:
        if before[name] is not None and name != "step":
            print(f"{name:>20}  {before[name]:>12.6g}  {after[name]:>12.6g}")
    best = beside(path, ".best.json")
    name = json.loads(best.read_bytes())["sha256"][:12]
    print(f"{len(rows) - 1} steps into {path}; the creature {name}: {best}")
