"""Commands that carry out runs without a server: evolve, refine; initial creatures."""

import json
import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.progress import MofNCompleteColumn, TimeRemainingColumn
from typer import Argument, Option

from .. import plugins
from ..archive import choices as choices_file
from ..archive import creature_h5, export, initial
from ..archive.atomic import place
from ..archive.creature import parse
from ..archive.file import load, read_table
from ..archive.file_names import beside
from ..archive.report import INFEASIBLE
from ..doctor.machine import memory_bytes
from ..sinks.address import parse_all
from ..spec import Archive, Evolution, Refinement, Spec, estimate
from ..spec import parse as parse_spec
from ..viz.figures import reading
from .app import (
    CreaturePath,
    Modules,
    OtherDevice,
    Set,
    app,
    fail,
    failing,
    load_modules,
    prepare_jax,
    progress_bar,
    refuse_input,
    say,
    stopping,
)
from .cluster import CERTIFICATE, Certificate
from .specs import changed, read_spec, spec_path, with_generations

CreatureFile = dict[str, Any]

From = Annotated[
    list[Path] | None,
    Option(
        "--from",
        exists=True,
        dir_okay=False,
        help="Start from a creature file, or from all elites of an archive; repeatable.",
    ),
]

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
        str,
        Argument(
            help="Spec file, - for standard input, name of a preset, or address of a shared "
            "archive."
        ),
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
        float,
        Option(min=0.0, help="Seconds between two checkpoints; 0: after each generation."),
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
    # A mistyped address is refused before JAX starts.
    with failing("--sink"):
        parse_all(sink or ())
    chosen = changed(read_spec(spec), settings or [])
    if generations is not None:
        chosen = with_generations(chosen, generations)
    path = archive or beside(spec_path(spec), ".h5")
    _refuse_unused(cluster, certificate)
    chosen_by_people = _read_choices(choices)
    inputs = [Path(spec), *(begin_from or ()), *([choices] if choices else [])]
    evaluations = prepare_run(chosen, path, inputs)
    from ..device import device_kind

    chosen, initial = with_initial(chosen, begin_from or (), path)
    say(f"{evaluations:,} evaluations on {device_kind()} into {path}")
    options = {**_over(cluster, certificate), "choices": chosen_by_people}
    options["sinks"] = sink or ()
    run_with_progress(chosen, path, checkpoint_seconds, other_device, initial, **options)
    best = beside(path, ".best.json")
    say(f"Done: {path}" + (f"; the best creature: {best}" if best.exists() else ""))


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
            creature=creature_h5.read(file.read_bytes()),
            archive=_archive(like),
            steps=steps,
            length=length,
            segment=segment,
        )
    prepare_run(spec, path, [file])
    run_with_progress(spec, path, 60.0, other_device)
    _print_comparison(path)


@app.command("plugins")
def list_plugins(module: Modules = None) -> None:
    """List plug-ins: names, titles, versions."""
    load_modules(module)
    for plugin in plugins.loaded():
        one = plugin.declaration
        unit = f" in {one.unit}" if one.unit else ""
        print(
            f"{one.name}  {one.kind}  {one.title}{unit}  ({one.source[:12]}, {plugin.location})"
        )


def prepare_run(spec: Spec, path: Path, inputs: Sequence[Path]) -> int:
    """Make the file's folder and start JAX; return the number of evaluations.

    Fail if the folder cannot be made, the run would write what is no file or an input, or the
    memory does not suffice.
    """
    with failing("--out needs a folder that can be made"):
        path.parent.mkdir(parents=True, exist_ok=True)
    with failing("--out"):
        place(path)
        best = beside(path, ".best.json")
        place(best)
    refuse_input(path, *inputs)
    refuse_input(best, *inputs)
    # The system ends a process that outgrows the memory, without a message.
    need, (memory, _) = estimate(spec), memory_bytes()
    if need.memory_bytes > memory:
        fail(f"the run needs about {need.memory_bytes:,} bytes of memory; there are {memory:,}")
    prepare_jax()
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

    with (
        failing(archive),
        stopping() as received,
        progress_bar(MofNCompleteColumn(), TimeRemainingColumn()) as progress,
    ):
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
        # The library names no option of the command line.
        except experiments.OtherDevice as error:
            raise ValueError(f"{error} To continue here anyway, add --other-device.") from error
    if not done:
        say(f"Stopped. The same command goes on from {archive}.")
        raise typer.Exit(130)


def _read_choices(path: Path | None) -> dict[int, choices_file.Files] | None:
    if path is None:
        return None
    with failing(f"--choices: {path}"):
        return choices_file.parse(path.read_bytes())


def _refuse_unused(cluster: str | None, certificate: Path | None) -> None:
    # The environment may name one for all runs.
    if certificate and not cluster and str(certificate) != os.environ.get(CERTIFICATE):
        fail("--certificate needs --cluster, the scheduler whose helpers compute too")


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
    if not report.coverage:
        # A best fitness of 0 would read as a creature that lies still.
        reasons = "".join(f"  {name}" for name in INFEASIBLE.of(report.summary))
        return f"no elite: {report.infeasible:,} of {report.evaluations:,} infeasible{reasons}"
    text = (
        f"QD score {report.qd_score:.2f}  coverage {100 * report.coverage:.1f} %  "
        f"best {report.best:.2f}"
    )
    summary = report.summary or {}
    if "cluster.efficiency" in summary:
        busy = 100 * summary["cluster.efficiency"]
        text = f"{text}  {summary['cluster.devices']} devices, {busy:.0f} % busy"
    if "corrected_qd_score" not in summary:
        return text
    return (
        f"{text}  corrected: QD score {summary['corrected_qd_score']:.2f}  "
        f"coverage {100 * summary['corrected_coverage']:.1f} %  "
        f"hit rate {100 * summary['hit_rate']:.1f} %"
    )


def _archive(like: str | None) -> Archive:
    if like is None:
        return Archive()
    bounds = getattr(read_spec(like), "archive", None)
    if bounds is None:
        fail(f"--like needs a spec with an archive, got {like}")
    return bounds


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


def with_initial(
    spec: Spec, paths: Sequence[Path], archive: Path
) -> tuple[Spec, list[CreatureFile]]:
    """Return the spec that names its initial creatures, and their files.

    A spec that already names creatures keeps them. Fail if one does not fit, or if its file is
    missing and there is no archive that holds it.
    """
    if not paths:
        count = len(spec.search.initial) if isinstance(spec, Evolution) else 0
        if count and not archive.exists():
            fail(f"`search.initial` names {count} creatures: --from needs the files with them")
        return spec, []
    if not isinstance(spec, Evolution):
        fail(f"--from needs a search's spec, got {spec.experiment}")
    files_by_name = {file["sha256"]: file for path in paths for file in creatures(path)}
    named = spec.search.initial or sorted(files_by_name)
    if lacking := [name for name in named if name not in files_by_name]:
        fail(
            f"--from needs the creatures that `search.initial` names; got none of {lacking[0]}"
        )
    with failing("--from"):
        search = {**spec.search.model_dump(mode="json"), "initial": named}
        chosen = parse_spec({**spec.model_dump(mode="json"), "search": search})
        assert isinstance(chosen, Evolution)
        files = [files_by_name[name] for name in named]
        initial.genes_of(chosen, files)
        return chosen, files


def creatures(path: Path) -> list[CreatureFile]:
    """Return the creatures of a creature file or an archive; fail for any other file."""
    with failing(f"--from needs a creature file or an archive; {path}"):
        data = path.read_bytes()
        if creature_h5.is_of_run(data):
            return _elites(data)
        return [creature_h5.read(data)]


def _elites(data: bytes) -> list[CreatureFile]:
    import jax

    from ..build import build

    run = reading.read(data)
    experiment = build(run.spec)
    # Row by row they would be fetched from the device over and over.
    state = jax.device_get(experiment.restore(data, other_device=True))
    files = [experiment.creature(state, cell) for cell in run.cells.tolist()]  # pyright: ignore
    terms = export.terms(load(data, only=())[1])
    return [parse(one | terms) for one in files]
