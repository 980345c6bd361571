"""The command-line application: shared options, errors, signals, progress, and plug-ins."""

import os
import signal
import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import wraps
from inspect import Signature, signature
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from pydantic import ValidationError
from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, SpinnerColumn, TextColumn
from rich.text import Text
from typer import Argument, Option
from typer.core import TyperGroup

from .. import plugins
from ..archive.atomic import place, write_whole
from ..client import ServerError
from ..client.formatting import visible_lines
from ..spec import invalid_fields
from ..version import VERSION


class Program(TyperGroup):
    """All commands, whose standard output loses nothing silently."""

    def main(self, *args: Any, **options: Any) -> Any:
        if sys.stdout is None:
            say("Standard output must be open; to discard it, add >/dev/null.", "red")
            sys.exit(1)
        # Paths may be no text, and an encoding may lack a sign such as µ. In a notebook the
        # output is another object, which takes both.
        if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.errors == "strict":
            sys.stdout.reconfigure(errors="backslashreplace")
        try:
            return super().main(*args, **options)
        finally:
            _flush()


def _flush() -> None:
    """Write what is left; a closed pipe or a full disk is met here, not when Python ends."""
    try:
        sys.stdout.flush()
    except OSError as error:
        # Python tries again at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):  # Its reader has seen enough.
            say(f"standard output: {error}", "red")
        sys.exit(1)


app = typer.Typer(
    cls=Program,
    help="Evolve swimming creatures, on this machine or on a server.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
console = Console(stderr=True)

CACHE = Path.home() / ".cache" / "microcosmos"
"""The default of JAX_COMPILATION_CACHE_DIR, the folder of compiled programs."""

CreaturePath = Annotated[
    Path, Argument(metavar="FILE", exists=True, dir_okay=False, help="A creature file.")
]
Set = Annotated[
    list[str] | None,
    Option(
        "--set",
        metavar="FIELD=VALUE",
        help="Set a field, such as world.viscosity=0.1; repeatable.",
    ),
]
OtherDevice = Annotated[
    bool, Option(help="Continue a run that another kind of device started.")
]


def _print_version(requested: bool) -> None:
    if requested:
        print(VERSION)
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool,
        Option("--version", callback=_print_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Options of the program itself."""


def with_options(
    make: Callable[..., AbstractContextManager[Any]],
    omit: Collection[str] = (),
    **defaults: Any,
) -> Callable[[Callable[..., Any]], Callable[..., None]]:
    """Add the options of `make` to a command; its result becomes the first argument."""
    added = [
        one.replace(default=defaults.get(one.name, one.default))
        for one in signature(make).parameters.values()
        if one.name not in omit
    ]

    def decorate(command: Callable[..., Any]) -> Callable[..., None]:
        @wraps(command)
        def run(**values: Any) -> None:
            with make(**{one.name: values.pop(one.name) for one in added}) as made:
                command(made, **values)

        own = list(signature(command).parameters.values())[1:]
        # Typer reads the options from the signature; `wraps` alone would show those of
        # `command`.
        run.__signature__ = Signature([*own, *added])  # pyright: ignore[reportAttributeAccessIssue]
        return run

    return decorate


@contextmanager
def stopping() -> Iterator[list[int]]:
    """Yield a list of the signals that came; the second one ends the process at once."""
    received: list[int] = []

    def note(number: int, frame: object) -> None:
        received.append(number)
        # The first signal lets a run write its checkpoint; a second one ends a run that hangs.
        signal.signal(number, signal.SIG_DFL)

    before = {one: signal.signal(one, note) for one in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield received
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def progress_bar(*columns: ProgressColumn) -> Progress:
    """Return a progress bar on standard error, which ends with a description."""
    return Progress(
        SpinnerColumn(),
        BarColumn(),
        *columns,
        TextColumn("{task.description}", markup=False),
        console=console,
    )


def deliver(content: bytes, out: Path | None) -> None:
    """Write a file and print its path; without one, write to standard output."""
    if out is None:
        # Bytes, since a TensorNEAT genome is no text (docs/networks.md).
        sys.stdout.buffer.write(content)
        sys.stdout.buffer.flush()
        return
    with failing("--out"):
        write_whole(out, content)
    print(out)


def refuse_input(out: Path | None, *inputs: Path, option: str = "--out") -> None:
    """Fail if a file to write is one that is read, by whatever path, or can be none."""
    if out is None:
        return
    with failing(option):
        for one in inputs:
            if out.exists() and one.exists() and out.samefile(one):
                fail(f"{option} must be another file than the one that is read; got {out}")
        if not place(out).parent.is_dir():
            raise NotADirectoryError(f"a file in an existing folder is needed, got {out}")


def say(text: str, style: str = "") -> None:
    """Print to standard error, for people; lines are not wrapped."""
    # A `Text`: brackets and `:fire:` in what people typed are neither markup nor pictures.
    console.print(Text(visible_lines(text), style), soft_wrap=True)


def fail(message: str, status: int = 2) -> NoReturn:
    """Print an error and exit."""
    say(message, "red")
    sys.exit(status)


@contextmanager
def failing(subject: str | Path = "") -> Iterator[None]:
    """Report errors about a file or an option, and exit with status 2, or 1 for a server's."""
    prefix = f"{subject}: " if subject else ""
    try:
        yield
    # First, since `ValidationError` is a `ValueError`: it has a line for each wrong field.
    except ValidationError as error:
        fail("\n".join(f"{prefix}{found}" for found in invalid_fields(error.errors())))
    except BrokenPipeError:  # The reader of the output has seen enough: Click ends quietly.
        raise
    except ServerError as error:  # The arguments may be right.
        fail(f"{prefix}{error}", 1)
    except (ValueError, ImportError, OSError) as error:
        fail(f"{prefix}{error}")


Modules = Annotated[
    list[Path] | None,
    Option("--module", help="A Python file with plug-ins, see docs/plugins.md; repeatable."),
]


def load_modules(files: list[Path] | None) -> None:
    """Load the plug-ins of installed packages and of these files; fail if a file is faulty."""
    # A faulty package must not stop commands that do without it; a named file must.
    for failed in plugins.load_all(()):
        say(f"{failed.module} is not loaded: {failed.reason}", "yellow")
    with failing("--module"):
        for file in files or ():
            plugins.load(file)


def prepare_engine(files: list[Path] | None) -> None:
    """Load plug-ins and JAX."""
    load_modules(files)
    prepare_jax()


def prepare_jax() -> None:
    """Load JAX; fail if a variable has a wrong value."""
    # Most commands start without JAX.
    from ..device import prepare

    with failing():
        prepare(cache=CACHE)
