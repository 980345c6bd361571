"""Commands for creature files: replay, audit, gradient."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..archive.atomic import write_whole
from ..archive.creature import CreatureError, parse
from ..plugins import Broken, Missing
from .app import CACHE, app, fail
from .modules import Modules, load_modules


@app.command()
def replay(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    check: Annotated[
        bool, typer.Option("--check", help="Evaluate again and compare bit for bit.")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="File to write the replay to.")] = None,
    module: Modules = None,
) -> None:
    """Simulate a creature file again."""
    load_modules(module)
    from ..device import prepare

    prepare(cache=CACHE)
    try:
        if check:
            _check(file)
        else:
            _record(file, out or file.with_suffix(".replay"))
    except (CreatureError, Missing, Broken, OSError) as error:
        fail(f"{file}: {error}")


@app.command()
def audit(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    out: Annotated[
        Path | None, typer.Option(help="File to write the report to, as JSON.")
    ] = None,
    module: Modules = None,
) -> None:
    """Audit the physics of a creature: does it still swim on a finer lattice?"""
    load_modules(module)
    from ..device import prepare

    prepare(cache=CACHE)
    from ..audit.physics import audit as examined

    try:
        found = examined(parse(file.read_bytes()))
    except (CreatureError, Missing, Broken, OSError) as error:
        fail(f"{file}: {error}")
    if out:
        write_whole(out, json.dumps(found, indent=1).encode())
    _print_audit(found)
    if not found["verdict"]["survives"]:
        raise typer.Exit(1)


@app.command()
def gradient(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    of: Annotated[str, typer.Option(help="fitness, or a measure.")] = "fitness",
    by: Annotated[
        list[str] | None,
        typer.Option(help="genes (default), rest_angle, rest_length, stretch, viscosity …"),
    ] = None,
    starts: Annotated[
        int, typer.Option(min=1, help="Number of other starts to compare with.")
    ] = 8,
    out: Annotated[
        Path | None, typer.Option(help="File to write the report to, as JSON.")
    ] = None,
    module: Modules = None,
) -> None:
    """Measure how far the gradient of a creature's fitness or of a measure can be trusted."""
    load_modules(module)
    from ..device import prepare

    prepare(cache=CACHE)
    from ..audit.derivatives import gradient_health

    try:
        parts = tuple(by or ["genes"])
        found = gradient_health(parse(file.read_bytes()), of, parts, starts=starts)
    except (CreatureError, ValueError, OSError) as error:
        fail(f"{file}: {error}")
    if out:
        write_whole(out, json.dumps(found.document(), indent=1).encode())
    for line in found.lines():
        print(line)


def _check(file: Path) -> None:
    from ..audit.reproducibility import check

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
    from ..viz.replay import record

    write_whole(out, record(parse(file.read_bytes())))
    print(out)


def _print_audit(found: Mapping[str, Any]) -> None:
    for row in found["rows"]:
        mark = {True: "pass", False: "FAIL", None: "    "}[row["passed"]]
        value = "none" if row["value"] is None else f"{row['value']:.4g} {row['unit']}"
        bar = f"  ({row['bar']})" if row["bar"] else ""
        print(f"{mark}  {row['quantity']}: {value.strip()}{bar}")
    survives = found["verdict"]["survives"]
    print("Its swimming survives." if survives else "Its swimming does not survive:")
    for reason in found["verdict"]["reasons"]:
        print(f"  {reason}")
