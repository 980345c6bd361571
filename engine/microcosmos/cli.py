"""The command line: evolve and replay without a server. JAX is loaded only to compute."""

import json
import os
import signal
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from pydantic import ValidationError
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeRemainingColumn,
)

from .spec import EXPERIMENTS, Spec, estimate, parse

app = typer.Typer(help=__doc__, no_args_is_help=True, pretty_exceptions_enable=False)
console = Console(stderr=True)

CACHE = Path.home() / ".cache" / "microcosmos"
"""Where compiled programs are kept, unless JAX_COMPILATION_CACHE_DIR says otherwise."""


@app.command()
def evolve(
    spec: Annotated[str, typer.Argument(help="A spec file, or the name of a preset.")],
    archive: Annotated[
        Path | None, typer.Option("--out", help="Archive file; default: beside the spec.")
    ] = None,
    checkpoint_seconds: Annotated[float, typer.Option(min=0.0)] = 60.0,
    other_device: Annotated[
        bool, typer.Option(help="Go on although another kind of device began the run.")
    ] = False,
) -> None:
    """Carry out a run; called again, it goes on from the archive file."""
    chosen = _read_spec(spec)
    path = archive or Path(spec).with_suffix(".h5")
    if not path.parent.is_dir():
        _fail(f"--out needs an existing folder; got {path.parent}")
    from .device import device_kind, prepare

    need = estimate(chosen)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if need.memory_bytes > memory:
        _fail(
            f"the run needs about {need.memory_bytes:,} bytes of memory; there are {memory:,}"
        )
    prepare(cache=CACHE)
    console.print(f"{need.evaluations:,} evaluations on {device_kind()} into {path}")
    if not _evolve(chosen, path, checkpoint_seconds, other_device):
        console.print(f"Stopped. The same command goes on from {path}.")
        raise typer.Exit(130)
    console.print(f"Done: {path}; the best creature: {path.with_suffix('.best.json')}")


@app.command()
def replay(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    check: Annotated[
        bool, typer.Option("--check", help="Evaluate again and compare bit for bit.")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="Where the replay is written.")] = None,
) -> None:
    """Simulate a creature file again."""
    from .archive.creature import CreatureError
    from .device import prepare

    prepare(cache=CACHE)
    try:
        if check:
            _check(file)
        else:
            _record(file, out or file.with_suffix(".replay"))
    except (CreatureError, OSError) as error:
        _fail(f"{file}: {error}")


def _read_spec(name: str) -> Spec:
    path = Path(name)
    presets = {p.name: p.spec for e in EXPERIMENTS.values() for p in e.presets}
    if not path.exists() and name in presets:
        return presets[name]
    if not path.exists():
        _fail(f"SPEC needs a file, or one of the presets {', '.join(presets)}; got {name}")
    try:
        return parse(json.loads(path.read_bytes()))
    except ValidationError as error:
        _fail("\n".join(f"{path}: {_said(found)}" for found in error.errors()))
    except (ValueError, RecursionError, OSError) as error:
        _fail(f"{path}: {error}")


def _said(error: Mapping[str, Any]) -> str:
    """The field, what was needed and what came, on one line."""
    field = ".".join(str(part) for part in error["loc"])
    needed = str(error["msg"]).removeprefix("Value error, ")
    return f"{field}: {needed}" + ("" if "got" in needed else f"; got {error['input']!r:.80}")


def _evolve(spec: Spec, archive: Path, checkpoint_seconds: float, other_device: bool) -> bool:
    """Carry the run on behind a progress bar; the first Ctrl-C asks it to stop."""
    from . import experiments, local

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
        bar = progress.add_task("compiling", total=spec.search.generations)

        def tell(report) -> None:
            text = (
                f"QD score {report.qd_score:.2f}  coverage {100 * report.coverage:.1f} %  "
                f"best {report.best:.2f}"
            )
            progress.update(bar, completed=report.generation, description=text)

        try:
            return local.evolve(
                spec,
                archive,
                stop=lambda: bool(wishes),
                tell=tell,
                checkpoint_seconds=checkpoint_seconds,
                other_device=other_device,
            )
        except experiments.OtherDevice as error:
            progress.stop()
            _fail(f"{archive}: {error} To go on here all the same: --other-device.")
        except (ValueError, OSError) as error:
            progress.stop()
            _fail(f"{archive}: {error}")


def _check(file: Path) -> None:
    from .archive.creature import parse
    from .render import check

    result = check(parse(file.read_bytes()))
    for name, repeated in result.repeated.items():
        recorded = result.recorded.get(name, float("nan"))
        print(f"{name:>18}  recorded {recorded:.9g}  repeated {repeated:.9g}")
    if result.exact:
        print("The same, bit for bit.")
        return
    reason = "" if result.same_device else ": it was measured on another kind of device"
    print(f"Not the same{reason}.")
    raise typer.Exit(1)


def _record(file: Path, out: Path) -> None:
    from .archive.creature import parse
    from .archive.store import write_whole
    from .render import record

    write_whole(out, record(parse(file.read_bytes())))
    print(out)


def _fail(message: str) -> NoReturn:
    console.print(message, style="red", markup=False)
    sys.exit(2)


if __name__ == "__main__":
    app()
